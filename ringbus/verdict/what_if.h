#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "accel/structure/accel.h"
#include "core/config/config.h"

namespace carousel::ringbus {

/// A class of the machine's parts, relaxed: with twice as many of them, or half their latency.
struct WhatIf {
  std::string name;               ///< as in the report: box_tests, link_bandwidth, ...
  std::string action;             ///< the keys that were doubled or halved
  std::vector<std::string> sets;  ///< these keys as values of --set
  std::function<void(Config&)> relax;
  Config relaxed;             ///< the machine with the class relaxed
  bool keeps_shapes = false;  ///< more room for shapes, which fills long after the machine is full of rays
};
/// The what-ifs of the classes that the configured machine with such a scene has: a row for each kind of test unit
/// (core/types/unit_kind.h), then the table of other parts, which has every other key that costs hardware. Classes
/// whose keys are at the end of their range are left out.
std::vector<WhatIf> what_ifs(const Config& config, const accel::Accel& accel);

/// The machine with all of these classes relaxed; absent if no configuration may say so.
std::optional<Config> relaxed_together(const Config& config, const std::vector<const WhatIf*>& members);

/// The configured machine with every class of parts but its test units relaxed, by the same table: doubled, or its
/// latency halved, six times (storage less often), as far as the keys' ranges allow. Topology and order of issue stay.
Config tester_limited(const Config& config);

}  // namespace carousel::ringbus
