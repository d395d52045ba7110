#pragma once

#include <cstdint>
#include <span>

#include "core/types/workload.h"
#include "ringbus/protocol/machine.h"
#include "ringbus/results/ray_times.h"
#include "ringbus/results/recording.h"
#include "ringbus/time/clock.h"

namespace carousel::ringbus::cycle {

/// Notes what ray control and shading do with the followed ray, where that is asked for. Every call is a comparison
/// where it is not. Keeps a reference to the machine.
class ShadingRecorder {
 public:
  explicit ShadingRecorder(Machine& machine) : machine_(machine) {}
  void record(const Recording& recording) {
    log_ = recording.ray;
    times_ = recording.times;
  }

  /// A worker made these rays from cycle `at` to cycle `end`, or shading caused them.
  void made(std::span<const RayRequest> rays, Cycle at, Cycle end) {
    if (times_ != nullptr) times_->made(rays, end);
    if (log_ != nullptr) [[unlikely]]
      note_made(rays, at, end);
  }
  /// Completed rays have come from a resource; they leave `slots`.
  void taken(ResourceId resource, const HitBatch& rays, std::span<const std::uint32_t> slots, Cycle now) {
    if (times_ != nullptr) times_->taken(resource, rays, slots, now);
    if (log_ != nullptr) [[unlikely]]
      note_taken(rays, now);
  }
  void begin_shading(const RayResult& ray, Cycle now) {
    if (times_ != nullptr) times_->begin_shading(ray.tag, now);
    if (log_ != nullptr && log_->ray->is(ray.tag)) [[unlikely]]
      shade_began_ = now;
  }
  /// To be called before the workload shades the rays, which may be told by it that the followed one is over.
  void shaded(const HitBatch& rays, Cycle now) {
    if (times_ != nullptr) times_->shaded(rays, now);
    if (log_ != nullptr) [[unlikely]]
      note_shaded(rays, now);
  }
  /// A ray or bundle has got a slot; `home` issues its packets.
  void placed(RayId id, std::uint32_t home, Cycle now) {
    if (times_ != nullptr) account_for(id, now);
    if (log_ != nullptr) [[unlikely]]
      note_placed(id, home, now);
  }
  /// The IDs of a group have been sent, and arrive in cycle `arrival`.
  void sent(std::span<const RayId> ids, Cycle arrival) {
    if (log_ != nullptr) [[unlikely]]
      note_sent(ids, arrival);
  }

 private:
  void account_for(RayId id, Cycle now);
  void note_made(std::span<const RayRequest> rays, Cycle at, Cycle end);
  void note_taken(const HitBatch& rays, Cycle now);
  void note_shaded(const HitBatch& rays, Cycle now);
  void note_placed(RayId id, std::uint32_t home, Cycle now);
  void note_sent(std::span<const RayId> ids, Cycle arrival);

  Machine& machine_;
  RayLog* log_ = nullptr;
  RayTimes* times_ = nullptr;
  Cycle shade_began_ = 0;  // of the followed ray
};

}  // namespace carousel::ringbus::cycle
