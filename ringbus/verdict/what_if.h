#pragma once

#include <optional>
#include <string>
#include <vector>

#include "accel/structure/accel.h"
#include "core/config/config.h"
#include "core/config/relaxation.h"

namespace carousel::ringbus {

/// A class of the machine's parts, relaxed: with twice as many of them, or half their latency.
struct WhatIf {
  Relaxation part;                ///< its name as in the report (box_tests, link_bandwidth, ...), and its keys
  std::vector<std::string> sets;  ///< these keys as values of --set
  Config relaxed;                 ///< the machine with the class relaxed

  const std::string& name() const { return part.part; }
};
/// A class that the machine has and of which no gain is told.
struct Untried {
  std::string name, action;
  std::string why;  ///< what reading such a configuration says, if none may relax it so; or that no rays were left
};
/// The what-ifs of the classes that the configured machine with such a scene has, in the order of the configuration's
/// keys, whose rows say how they are relaxed. Classes that cannot be relaxed so are left out, and added to `untried`:
/// their keys are near the end of their range, for example.
std::vector<WhatIf> what_ifs(const Config& config, const accel::Accel& accel, std::vector<Untried>* untried = nullptr);

/// The machine with all of these classes relaxed; absent if no configuration may say so.
std::optional<Config> relaxed_together(const Config& config, const std::vector<const WhatIf*>& members);

/// The configured machine with every class of parts but its test units relaxed, by the same table: doubled, or its
/// latency halved, six times (storage less often), as far as the keys' ranges allow. Topology and order of issue stay.
Config tester_limited(const Config& config);

}  // namespace carousel::ringbus
