#pragma once

#include <cstdint>

#include "core/types/ids.h"

namespace carousel::ringbus {

/// The part of a machine that one of several processes, its ranks, plays: an arc of neighbouring resources, and in each
/// resource of the whole machine some of the slots. A rank hands out the slots that it leases, wherever they are, so
/// that its rays are spread over all resources and no two ranks give away one slot. The resource's own rank keeps the
/// rays in them; a ray that has completed goes back to the rank that leases its slot, which shades it.
class RankShare {
 public:
  RankShare() = default;
  /// Preconditions: rank < ranks, ranks <= resources.
  RankShare(std::uint32_t rank, std::uint32_t ranks, std::int64_t resources)
      : rank_(rank), ranks_(ranks), resources_(static_cast<std::uint64_t>(resources)) {}

  std::uint32_t rank() const { return rank_; }
  std::uint32_t ranks() const { return ranks_; }
  /// The whole machine is in this process.
  bool alone() const { return ranks_ == 1; }

  /// The first resource of a rank's arc, which ends where that of the next rank begins.
  std::uint32_t arc_begin(std::uint32_t rank) const { return static_cast<std::uint32_t>(resources_ * rank / ranks_); }
  std::uint32_t arc_begin() const { return arc_begin(rank_); }
  std::uint32_t arc_end() const { return arc_begin(rank_ + 1); }
  std::uint32_t arc_size() const { return arc_end() - arc_begin(); }
  /// The rank that plays a resource.
  std::uint32_t rank_of(ResourceId r) const {
    return alone() ? 0 : static_cast<std::uint32_t>(((std::uint64_t{r.value} + 1) * ranks_ - 1) / resources_);
  }
  bool here(ResourceId r) const { return alone() || rank_of(r) == rank_; }

  /// The first slot of any resource that a rank leases, of `slots`; the next rank's begin where these end.
  std::uint32_t lease_begin(std::uint32_t rank, std::uint32_t slots) const {
    return static_cast<std::uint32_t>(std::uint64_t{slots} * rank / ranks_);
  }
  std::uint32_t lease_begin(std::uint32_t slots) const { return lease_begin(rank_, slots); }
  std::uint32_t lease_end(std::uint32_t slots) const { return lease_begin(rank_ + 1, slots); }
  /// The rank that leases a slot.
  std::uint32_t lessee(std::uint32_t slot, std::uint32_t slots) const {
    return alone() ? 0 : static_cast<std::uint32_t>(((std::uint64_t{slot} + 1) * ranks_ - 1) / slots);
  }

 private:
  std::uint32_t rank_ = 0, ranks_ = 1;
  std::uint64_t resources_ = 0;
};

}  // namespace carousel::ringbus
