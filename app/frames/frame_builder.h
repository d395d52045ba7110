#pragma once

#include <cstdint>
#include <optional>
#include <stop_token>
#include <vector>

#include "accel/builders/refit.h"
#include "app/run/prepare.h"
#include "report/sections/structure/frames.h"

namespace carousel::app {

/// This is what the builder of a simulated machine did for a frame.
struct BuilderFrame {
  report::FrameUpdateCost cost;
  bool complete = true;
};

/// The builder brings the parts of the structure to what it now is: by a refit, or by a build from the top down. Then
/// lines that it wrote leave `cached`, the lines of each shared cache; after a build all of the structure do, since its
/// nodes have other places.
BuilderFrame build_in_machine(const Prepared& prepared, const accel::ChangedParts& parts, bool refit,
                              const std::stop_token& stop, std::vector<std::vector<std::uint64_t>>& cached);

/// The cycles in which the builder would build the parts of `rebuilt`, which correspond to those of the structure.
std::uint64_t rebuild_cycles(const Prepared& prepared, const accel::Accel& rebuilt, const accel::ChangedParts& parts,
                             const std::stop_token& stop);

}  // namespace carousel::app
