#pragma once

#include <algorithm>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "accel/structure/tree_pieces.h"
#include "core/config/fields/testers.h"
#include "core/statistics/warp_counts.h"
#include "ringbus/time/clock.h"

namespace carousel::ringbus::cycle {

/// Chooses treelets of the tree for the rays in warps (Y. Chou, T. Nowicki, T. Aamodt, Treelet prefetching for ray
/// tracing, MICRO 2023). A ray votes for the treelet in which its next node is. A table has a treelet as long as a ray
/// is there. When the last treelet has been read, the one with the most votes is chosen, `vote_cycles` later; each is
/// chosen once for each time that it comes into the table. Of equal ones the first in memory is chosen.
class TreeletPrefetcher {
 public:
  /// Keeps a reference to `pieces`, which may be null where nothing is prefetched.
  TreeletPrefetcher(const SimtConfig& config, const accel::TreePieces* pieces, std::uint32_t slots)
      : pieces_(config.prefetch == SimtConfig::Prefetch::kTreelet ? pieces : nullptr),
        least_(static_cast<std::uint32_t>(config.prefetch_rays)),
        takes_(static_cast<Cycle>(config.vote_cycles)) {
    if (pieces_ != nullptr) at_.assign(slots, accel::TreePieces::kNowhere);
  }

  bool on() const { return pieces_ != nullptr; }
  /// The next node of the ray in `slot` is `ref`.
  void vote(std::uint32_t slot, accel::NodeRef ref, Cycle now) {
    if (on()) move(slot, pieces_->index(ref), now);
  }
  /// The ray has ended.
  void leave(std::uint32_t slot, Cycle now) {
    if (on()) move(slot, accel::TreePieces::kNowhere, now);
  }

  /// The time of the next choice; kNever if there is nothing to choose.
  Cycle next() const { return due_; }
  /// The treelet that is chosen at `now`, or null.
  const accel::TreePieces::Piece* choose(Cycle now) {
    if (due_ > now) return nullptr;
    due_ = kNever;
    std::uint32_t best = accel::TreePieces::kNowhere, most = 0;
    for (const auto& [piece, entry] : table_) {
      if (entry.chosen || entry.votes < least_) continue;
      if (entry.votes > most || (entry.votes == most && piece < best)) best = piece, most = entry.votes;
    }
    if (most == 0) return nullptr;
    table_[best].chosen = reading_ = true;
    ++counts_.prefetches;
    return &pieces_->pieces[best];
  }
  /// All lines of the chosen treelet have been asked for.
  void read(Cycle now) {
    reading_ = false;
    due_ = now + takes_;
  }
  const WarpCounts& counts() const { return counts_; }

 private:
  struct Entry {
    std::uint32_t votes = 0;
    bool chosen = false;
  };

  void move(std::uint32_t slot, std::uint32_t to, Cycle now) {
    std::uint32_t& at = at_[slot];
    if (at == to) return;
    if (at != accel::TreePieces::kNowhere)
      if (const auto left = table_.find(at); --left->second.votes == 0) table_.erase(left);
    at = to;
    if (table_.empty()) due_ = kNever;
    if (to == accel::TreePieces::kNowhere) return;
    ++counts_.votes;
    Entry& entry = table_[to];
    ++entry.votes;
    if (!reading_ && due_ == kNever && !entry.chosen && entry.votes >= least_) due_ = now + takes_;
  }

  const accel::TreePieces* pieces_;
  std::uint32_t least_;
  Cycle takes_, due_ = kNever;
  bool reading_ = false;
  std::vector<std::uint32_t> at_;                   // by slot
  std::unordered_map<std::uint32_t, Entry> table_;  // by treelet; no more than there are rays
  WarpCounts counts_;                               // votes and prefetches alone
};

}  // namespace carousel::ringbus::cycle
