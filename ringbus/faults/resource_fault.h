#pragma once

#include <chrono>
#include <cstdint>
#include <optional>

#include "core/config/fields/faults.h"
#include "core/config/fields/testers.h"
#include "core/types/ids.h"
#include "ringbus/schedule/schedule.h"

namespace carousel::ringbus {

/// Makes a resource of the native engine pause, or slower than the others, by deciding which of its steps are taken.
/// While the resource rests, its port rests too, and packets wait in its links.
class ResourceFault {
 public:
  /// The fault of resource `id`, if it has one.
  static std::optional<ResourceFault> of(const FaultsConfig::Resource& fault, std::int64_t clock_mhz, ResourceId id) {
    using Kind = FaultsConfig::Resource::Kind;
    if ((fault.kind != Kind::kPause && fault.kind != Kind::kSlow) || fault.number != id.value) return std::nullopt;
    return ResourceFault(fault, clock_mhz);
  }

  /// Takes the step unless the resource rests. Returns the step's result, or false.
  template <class Step>
  bool step(std::uint64_t rays_completed, const Step& take) {
    using Kind = FaultsConfig::Resource::Kind;
    rests_ = false;
    if (rays_completed < after_ || (kind_ == Kind::kPause && paused_ && Clock::now() >= until_)) return take();
    if (kind_ == Kind::kPause) {
      if (!paused_) until_ = Clock::now() + pause_;
      paused_ = rests_ = true;
      return false;
    }
    const Clock::time_point begin = Clock::now();
    rests_ = begin < until_;
    if (rests_) return false;
    const bool moved = take();
    if (moved) until_ = begin + factor_ * (Clock::now() - begin);
    return moved;
  }
  /// The last step was not taken since the resource rests. Its rest ends by itself.
  bool rests() const { return rests_; }

 private:
  using Clock = ScheduleClock;
  ResourceFault(const FaultsConfig::Resource& fault, std::int64_t clock_mhz)
      : kind_(fault.kind),
        after_(static_cast<std::uint64_t>(fault.after_rays)),
        pause_(fault.cycles * 1000 / clock_mhz),
        factor_(fault.factor) {}

  FaultsConfig::Resource::Kind kind_;
  std::uint64_t after_;
  std::chrono::nanoseconds pause_;
  std::int64_t factor_;
  bool paused_ = false, rests_ = false;
  Clock::time_point until_{};  // the resource rests until then
};

/// Slows the testers of resource `id` down if it has that fault: under virtual time a slow resource has slow testers,
/// from the beginning.
inline void slow_down(TestersConfig& testers, const FaultsConfig& faults, ResourceId id) {
  const FaultsConfig::Resource& fault = faults.resource;
  if (fault.kind != FaultsConfig::Resource::Kind::kSlow || fault.number != id.value) return;
  for (const auto [kind, units] : testers.units) {
    units.interval_cycles *= fault.factor;
    units.latency_cycles *= fault.factor;
  }
}

}  // namespace carousel::ringbus
