#pragma once

#include <cstdint>

#include "core/config/fields/faults.h"
#include "core/statistics/resource_counts.h"
#include "core/types/ids.h"
#include "ringbus/time/clock.h"

namespace carousel::ringbus::cycle {

/// When a resource stops or pauses (`faults.resource`), and whether it has told ray control that its work has come to
/// nothing since another one has stopped.
class FailStop {
 public:
  /// `owns_rays`: false for a packet process that serves resources. No ray completes there, so it counts the IDs that
  /// it has taken in.
  FailStop(const FaultsConfig::Resource& fault, ResourceId here, bool owns_rays)
      : fault_(fault), owns_rays_(owns_rays) {
    using Kind = FaultsConfig::Resource::Kind;
    const bool is_here = fault.number == here.value;
    pauses_ = is_here && fault.kind == Kind::kPause;
    stops_ = is_here && fault.kind == Kind::kStop;
  }

  /// Neither has happened yet, and one of them will.
  bool is_ahead() const { return pauses_ || stops_; }
  /// Tells whether the resource stops now, by what it has counted; once.
  bool stops(const ResourceCounts& counts) {
    if (!stops_ || !is_due(counts)) return false;
    stops_ = false;
    return true;
  }
  /// The cycles for which it pauses from now on; once, otherwise 0.
  Cycle pauses(const ResourceCounts& counts) {
    if (!pauses_ || !is_due(counts)) return 0;
    pauses_ = false;
    return static_cast<Cycle>(fault_.cycles);
  }
  /// The one that stops.
  ResourceId stopped() const { return ResourceId(static_cast<std::uint32_t>(fault_.number)); }

  /// Nothing is under way any more. Tells whether ray control has to be told so; once until begin_anew().
  bool tells_drained() {
    const bool tells = !drained_sent_;
    drained_sent_ = true;
    return tells;
  }
  void begin_anew() { drained_sent_ = false; }

  void count_discarded(std::uint64_t packets) { discarded_ += packets; }
  std::uint64_t packets_discarded() const { return discarded_; }

 private:
  bool is_due(const ResourceCounts& counts) const {
    const std::uint64_t rays = owns_rays_ ? counts.rays_completed : counts.rays_admitted;
    return rays >= static_cast<std::uint64_t>(fault_.after_rays);
  }

  FaultsConfig::Resource fault_;
  bool owns_rays_;
  bool pauses_ = false, stops_ = false, drained_sent_ = false;
  std::uint64_t discarded_ = 0;
};

}  // namespace carousel::ringbus::cycle
