#pragma once

#include <cstddef>
#include <cstdint>

#include "core/config/fields/bundles.h"
#include "core/config/fields/collections.h"
#include "core/config/fields/packets.h"
#include "ringbus/resource/collections/collection_store.h"

namespace carousel::ringbus {

/// Collection blocks that must stay free so that draining deepest first cannot run out (docs/how-it-works/design.md,
/// Deadlock and the end): a packet retired at each level leaves at most width - 1 more blocks than it took, and one
/// more strip's worth is in flight. If packets are made per child, an ID becomes as many as a child has shapes. With
/// bundles an ID may become as many at one level as a bundle has rays. None are needed where a ray is in one collection
/// at a time, as a new ray enters only if a place is left for it.
std::uint32_t reserve_blocks(const CollectionsConfig& collections, const PacketsConfig& packets,
                             const BundlesConfig& bundles, int width, int max_depth);
/// Blocks that a packet's retirement may take at most.
std::int64_t most_blocks(const PacketsConfig& packets, const BundlesConfig& bundles, int width);

/// IDs in a block of collection storage: packets.rays, or 1 where a ray is in one collection at a time. There the rays
/// of a packet may join as many collections as they are, each with a block of its own, so that larger blocks would
/// leave room for only one ray each.
std::int64_t block_rays(const CollectionsConfig& collections, const PacketsConfig& packets);

/// Keeps bounded collection storage (`when_full: reserve`) from blocking: says how many new rays may enter and when a
/// packet may be issued. With `when_full: spill` everything may.
class StorageRule {
 public:
  /// `reserve` as reserve_blocks() says, `block_rays` as block_rays() does. `collections`: that a new ray
  /// joins. Keeps a reference to `store`.
  StorageRule(const CollectionsConfig& config, std::int64_t block_rays, std::uint32_t reserve, std::int64_t collections,
              const CollectionStore& store);

  /// How many rays may join the root's collection now.
  std::size_t admissible() const;
  void admit(std::size_t rays) { rays_held_ += static_cast<std::uint32_t>(rays); }

  /// True if a packet may be issued whose retirement may take `needed` blocks, when its issue frees `freed`.
  bool fits(std::uint32_t needed, std::uint32_t freed) const;
  void issue(std::uint32_t needed) { blocks_promised_ += needed; }
  /// A packet that was issued with `needed` is back; of its `rays`, `joined` are in collections again.
  void retire(std::uint32_t needed, std::size_t rays, std::size_t joined);

  void discard() { blocks_promised_ = rays_held_ = 0; }

 private:
  bool bounded_, single_;  // single_: a ray is in one collection at a time, a block holds one ID
  std::int64_t block_rays_, blocks_;
  std::uint32_t reserve_;
  std::int64_t collections_;
  const CollectionStore& store_;
  std::uint32_t blocks_promised_ = 0;  // to packets in flight
  std::uint32_t rays_held_ = 0;        // in collections or in packets; counted with single_
};

}  // namespace carousel::ringbus
