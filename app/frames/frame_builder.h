#pragma once

#include <cstdint>
#include <optional>
#include <stop_token>
#include <vector>

#include "accel/builders/clusters.h"
#include "accel/builders/refit.h"
#include "app/run/prepare.h"
#include "core/config/fields/image.h"
#include "report/sections/structure/frames.h"

namespace carousel::app {

/// This is what the builder of a simulated machine did for a frame.
struct BuilderFrame {
  report::FrameUpdateCost cost;
  bool complete = true;
};

/// An update of clusters that the host has done.
struct DoneClusters {
  const accel::TreeClusters& clusters;
  const std::vector<accel::ClusterWork>& work;
};

/// The builder brings the parts of the structure to what it now is: by a refit, by an update of clusters, or by a build
/// from the top down. Then lines that it wrote leave `cached`, the lines of each shared cache, but for the L2 that it
/// asked (`frames.builder.asks`); after a build all of the structure do, since its nodes have other places. Lines that
/// others wrote before it leave all caches first.
BuilderFrame build_in_machine(const Prepared& prepared, const accel::ChangedParts& parts, FrameUpdate update,
                              const DoneClusters* done, const std::stop_token& stop,
                              std::vector<std::vector<std::uint64_t>>& cached);

/// What the builder would spend on building the parts of `rebuilt`, which correspond to those of the structure, with
/// caches that hold nothing.
report::FrameUpdateCost rebuild_cost(const Prepared& prepared, const accel::Accel& rebuilt,
                                     const accel::ChangedParts& parts, const std::stop_token& stop);

}  // namespace carousel::app
