#pragma once

#include <cstdint>

#include "accel/structure/node.h"
#include "ringbus/packets/packet.h"
#include "ringbus/resource/collections/collection_store.h"
#include "ringbus/resource/visit/local_rays.h"
#include "ringbus/resource/visit/test_outcome.h"

namespace carousel::ringbus {

/// How a resource's rays go down the tree (`collections.traversal`, `packets.shapes`, `bundles`): how many tests a ray
/// waits for, what a packet's visit does, and which collections its members join when it is back. One thread at a time.
class TraversalMethod {
 public:
  virtual ~TraversalMethod() = default;

  /// Tests that a ray waits for when it comes to `key`, and so the packets that carry a block of its collection, or one
  /// of each of its collections.
  virtual std::int32_t tests_at(accel::NodeKey key) const = 0;
  /// Collections that a ray joins then: one, or with `packets.made_per: child` one for each test.
  virtual std::int32_t collections_at(accel::NodeKey /*key*/) const { return 1; }
  /// Shapes of the strip that the n-th of these packets tests, a bit a lane.
  virtual std::uint32_t lanes(std::uint32_t n) const = 0;
  /// Collection blocks that retire() may take for a packet with `rays` members at `key`.
  virtual std::uint32_t blocks_needed(accel::NodeKey key, std::uint32_t rays) const = 0;
  /// True if one visit takes rays through the whole subtree below `key`.
  virtual bool is_treelet(accel::NodeKey /*key*/) const { return false; }

  /// Sets aside what test() writes into a packet that goes out, besides the members' masks.
  virtual void prepare(Packet& /*packet*/) const {}
  /// Tests the members of `packet` that are in `local` (never empty), writes the answers into the packet, changes the
  /// rays' counts of pending tests, and adds the cost to `outcome`. May change `local`.
  virtual void test(Packet& packet, LocalRays& local, TestOutcome& outcome) = 0;
  /// Lets the members of a packet that is back at its owner join the collections of the nodes they hit.
  virtual void retire(const Packet& packet, CollectionStore& collections) = 0;
  /// Forgets all rays, however far they are.
  virtual void discard() {}
};

}  // namespace carousel::ringbus
