#pragma once

#include <cstdint>
#include <string>

#include "accel/structure/accel.h"
#include "bench/common/ray_sets.h"
#include "core/config/config.h"
#include "ringbus/native/native_engine.h"

namespace carousel::bench {

/// Settings common to all ring contestants.
struct RingSettings {
  std::int64_t slots = 65536;              ///< rays.slots_per_resource
  std::int64_t packet_rays = 512;          ///< packets.rays
  std::int64_t ready = 512;                ///< collections.ready
  std::int64_t capacity = 1 << 24;         ///< collections.capacity, ray IDs; a collection takes whole packets of it
  std::int64_t treelet_triangles = 32768;  ///< bvh.treelet_triangles
  std::int64_t link_depth = 16;            ///< topology.link.depth
  Policy policy = Policy::kNearest;
  Select select = Select::kStrict;
  Lanes lanes = Lanes::kAuto;     ///< engine.lanes
  RaySort sort = RaySort::kNone;  ///< rays.sort
  QueueKind queue = QueueKind::kSpscRing;
};

/// Changes settings by the text "key=value;key=value", with the names of bench_rays' flags as keys: slots,
/// packet-rays, ready, capacity, treelet, link-depth, policy, select, lanes, sort, queue. Throws ConfigError.
RingSettings with_changes(RingSettings settings, const std::string& changes);

/// One configuration of the ring.
struct RingForm {
  Traversal traversal = Traversal::kTreelet;
  Home home = Home::kLocal;
  std::int64_t resources = 1;
  bool statistics = false;
  bool link_statistics = false;
  BundlesConfig bundles{};
};

struct RingRun {
  ringbus::RunResult result;
  double to_first_packet_seconds = 0;  ///< from the call to the first request for rays
};

/// The configuration of a run on `threads` threads, with as many shader workers.
Config ring_config(const RingSettings& settings, const RingForm& form, int threads);

/// Traces the set on the native ring; stops after `limit_seconds`, with a result that is not complete. Throws
/// SimulationError when the ring breaks.
RingRun run_ring(const accel::Accel& accel, float scene_size, const RingSettings& settings, const RingForm& form,
                 const RaySet& rays, int threads, HitList& hits, double limit_seconds = 20);

}  // namespace carousel::bench
