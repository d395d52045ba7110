#pragma once

#include <cstdint>
#include <deque>
#include <optional>
#include <span>
#include <vector>

#include "accel/structure/node.h"
#include "core/config/fields/collections.h"
#include "core/numeric/log2_histogram.h"
#include "core/statistics/collection_counts.h"
#include "ringbus/rays/ray_id.h"
#include "ringbus/resource/collections/collection_table.h"
#include "ringbus/resource/collections/issue_policy.h"
#include "ringbus/resource/collections/priority_lists.h"

namespace carousel::ringbus {

using CollectionId = Id<struct CollectionTag>;

/// IDs of a spilled block that move to memory, or back from it.
struct SpillMove {
  std::uint32_t block = 0;           ///< number of the spilled block
  std::uint32_t first = 0, ids = 0;  ///< places within it
};
/// Spilled entries that have moved since an engine last looked. It clears both.
struct SpillMoves {
  std::vector<SpillMove> written, read;
};

/// A resource's collections: ray IDs in fixed blocks, a chain of blocks a collection, all but the last one full.
/// A block holds as many IDs as a packet carries, so issuing a packet frees exactly one block; or a single ID, so
/// that storage is taken only for the IDs there are, and issuing a packet frees a block for each of its rays.
class CollectionStore {
 public:
  struct Settings {
    std::uint32_t block_rays = 32;   ///< packets.rays, or 1
    std::uint32_t packet_rays = 32;  ///< packets.rays
    std::uint32_t ready = 32;
    std::uint32_t capacity_blocks = 2048;
    Policy policy = Policy::kNearest;
    Select select = Select::kFullFirst;
    float scene_size = 1;
    int max_depth = 1;  ///< depth of the structure, in strips
    /// A collection that has waited for so long is ready, however few rays it has; 0: it is not.
    std::uint64_t ripe_after = 0;
    bool reports_spills = false;  ///< spilled entries are noted in spills(), for an engine that empties it
  };
  using Statistics = CollectionCounts;

  explicit CollectionStore(const Settings& settings);

  /// Adds rays to the collection of `key`, or of one shape of its strip, created if need be. `entry` is the nearest
  /// entry of any of them. Takes at most one new block when at most block_rays rays are added. Without a free block
  /// within the capacity it takes one in memory, a spilled one, until that is taken away; the caller says whether that
  /// may happen (StorageRule). Spilled blocks are numbered from 0 on, and a new one takes the number that was given up
  /// last.
  void add(accel::NodeKey key, std::uint16_t depth, float entry, std::span<const RayId> rays, std::uint8_t shape = 0);

  /// The collection to issue from, by policy: among those that are ready, or with `partial` among all; with
  /// `select: strict` always among all.
  std::optional<CollectionId> best(bool partial) const;
  /// The deepest collection, whatever the policy. Takes time in proportion to the number of collections.
  std::optional<CollectionId> deepest() const;

  accel::NodeKey key(CollectionId id) const { return collections_[id.value].key; }
  std::uint8_t shape(CollectionId id) const { return collections_[id.value].shape; }
  std::uint16_t depth(CollectionId id) const { return collections_[id.value].depth; }
  bool is_ready(CollectionId id) const { return collections_[id.value].ready; }
  float entry(CollectionId id) const { return collections_[id.value].entry; }
  /// How many rays the next take() gives.
  std::uint32_t front_rays(CollectionId id) const;
  /// How many blocks it frees.
  std::uint32_t front_blocks(CollectionId id) const;
  /// Moves the rays of the first packet to `rays`; an empty collection ceases to exist. `joined`, if not null, gets the
  /// low half of the time of ripen() at which each of them joined.
  void take(CollectionId id, std::vector<RayId>& rays, std::vector<std::uint32_t>* joined = nullptr);

  /// The time is `now`, also for ages(): collections that have waited for Settings::ripe_after become ready. A
  /// collection waits from its first ray on, or since rays were taken from it.
  void ripen(std::uint64_t now) {
    now_ = now;
    if (settings_.ripe_after > 0) ripen();
  }
  /// The time at which the next collection will be ready for having waited; absent if none will.
  std::optional<std::uint64_t> next_ripe();

  /// With Settings::reports_spills.
  SpillMoves& spills() { return spills_; }

  /// Forgets all collections; the statistics go on.
  void discard();

  bool empty() const { return table_.size() == 0; }
  std::size_t collections() const { return table_.size(); }
  std::size_t memberships() const { return memberships_; }
  /// Below zero when spilled.
  std::int64_t free_blocks() const {
    return std::int64_t{settings_.capacity_blocks} - static_cast<std::int64_t>(blocks_used_);
  }
  const Statistics& statistics() const { return statistics_; }
  /// How long collections had waited when a packet was taken from them, since their first ray or since the last packet.
  /// In the time of ripen(); without it, nothing but zeros.
  const Log2Histogram& ages() const { return ages_; }

 private:
  struct Collection {
    accel::NodeKey key;
    std::uint32_t head = 0, tail = 0;  // blocks
    std::uint32_t count = 0;
    std::uint64_t since = 0;  // it waits
    float entry = 0;
    std::uint16_t depth = 0;
    bool ready = false;
    bool ripe = false;        // it has waited for long enough
    std::uint32_t waits = 0;  // how often it has begun to wait, to tell old entries of waiting_ from its own
    std::uint8_t shape = 0;
  };
  struct Waiting {
    std::uint64_t since;
    std::uint32_t collection, waits;
  };

  std::uint32_t new_collection(accel::NodeKey key, std::uint16_t depth, float entry, std::uint8_t shape);
  std::uint32_t new_block();
  void free_block(std::uint32_t block);
  std::uint32_t bucket(const Collection& c) const;
  PriorityLists& list(const Collection& c) { return c.ready ? ready_ : partial_; }
  void enlist(std::uint32_t index, std::uint32_t bucket);
  void relist(std::uint32_t index, bool was_ready);
  void begin_to_wait(std::uint32_t index);
  void ripen();

  Settings settings_;
  const IssuePolicy* policy_;
  PolicyScale scale_;
  CollectionTable table_;
  PriorityLists ready_, partial_;
  std::vector<Collection> collections_;
  std::vector<std::uint32_t> free_collections_;
  std::deque<Waiting> waiting_;  // with ripe_after, oldest first; also of collections that have begun to wait anew
  std::uint64_t now_ = 0;
  std::vector<RayId> block_rays_;          // block_rays IDs a block
  std::vector<std::uint32_t> joined_;      // of each of these IDs: the low half of the time
  std::vector<std::uint32_t> next_block_;  // one a block
  std::vector<std::uint32_t> free_blocks_;
  static constexpr std::uint32_t kNotSpilled = ~0u;
  std::vector<std::uint32_t> spilled_as_;  // one a block: its number as a spilled block
  std::vector<std::uint32_t> free_numbers_;
  std::uint32_t numbers_ = 0;
  std::size_t blocks_spilled_ = 0;
  SpillMoves spills_;
  std::size_t blocks_used_ = 0, memberships_ = 0;
  Statistics statistics_;
  Log2Histogram ages_;
};

}  // namespace carousel::ringbus
