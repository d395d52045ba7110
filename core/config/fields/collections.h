#pragma once

#include <cstdint>

#include "core/config/fields/engine_kind.h"
#include "core/config/fields/field.h"

namespace carousel {

enum class Traversal { kSpread, kOrdered, kTreelet };
template <>
inline constexpr auto kEnumNames<Traversal> = [] {
  using enum Traversal;
  return names<Traversal>({{kSpread, "spread"}, {kOrdered, "ordered"}, {kTreelet, "treelet"}});
}();

enum class ChildOrder { kNearest, kStored };
template <>
inline constexpr auto kEnumNames<ChildOrder> = [] {
  using enum ChildOrder;
  return names<ChildOrder>({{kNearest, "nearest"}, {kStored, "stored"}});
}();

enum class CollectionKey { kNode, kBlock };
template <>
inline constexpr auto kEnumNames<CollectionKey> = [] {
  using enum CollectionKey;
  return names<CollectionKey>({{kNode, "node"}, {kBlock, "block"}});
}();

enum class Policy { kFullest, kOldest, kNewest, kDeepest, kNearest };
template <>
inline constexpr auto kEnumNames<Policy> = [] {
  using enum Policy;
  return names<Policy>(
      {{kFullest, "fullest"}, {kOldest, "oldest"}, {kNewest, "newest"}, {kDeepest, "deepest"}, {kNearest, "nearest"}});
}();

template <>
inline constexpr std::string_view kAddedAs<Policy> = "policy";

enum class Select { kStrict, kFullFirst };
template <>
inline constexpr auto kEnumNames<Select> = [] {
  using enum Select;
  return names<Select>({{kStrict, "strict"}, {kFullFirst, "full_first"}});
}();

enum class Partial { kIdle, kAhead, kAfter };
template <>
inline constexpr auto kEnumNames<Partial> = [] {
  using enum Partial;
  return names<Partial>({{kIdle, "idle"}, {kAhead, "ahead"}, {kAfter, "after"}});
}();

enum class Home { kIssuer, kHash, kLocal };
template <>
inline constexpr auto kEnumNames<Home> = [] {
  using enum Home;
  return names<Home>({{kIssuer, "issuer"}, {kHash, "hash"}, {kLocal, "local"}});
}();

enum class WhenFull { kReserve, kSpill };
template <>
inline constexpr auto kEnumNames<WhenFull> = [] {
  using enum WhenFull;
  return names<WhenFull>({{kReserve, "reserve"}, {kSpill, "spill"}});
}();

struct CollectionsConfig {
  std::int64_t ready = 32;
  Traversal traversal = Traversal::kSpread;
  ChildOrder order = ChildOrder::kNearest;
  CollectionKey key = CollectionKey::kNode;
  std::int64_t block_bytes = 1024;
  Policy policy = Policy::kNearest;
  Select select = Select::kFullFirst;
  Partial partial = Partial::kAhead;
  std::int64_t partial_after_cycles = 1000;
  bool grouped = false;
  Home home = Home::kIssuer;
  std::int64_t capacity = 65536, sort_ids_per_cycle = 0;
  WhenFull when_full = WhenFull::kReserve;
};

namespace config {

template <class V>
void describe(V& v, CollectionsConfig& c) {
  v.field("ready", c.ready, IntRange{1, 65536}, "rays",
          "The number of rays that make a collection ready. More than packets.rays leave in several packets.");
  v.choice("traversal", c.traversal,
           "The way of a ray down the tree: into all children that it hits (spread), into the nearest one first "
           "(ordered), or through a whole subtree at one visit (treelet).");
  v.choice("order", c.order,
           "A ray that goes depth first, which is with traversal: ordered, in treelets and on independent resources, "
           "takes of the children that it hits the nearest one first, or the first one in the order of the node.");
  v.choice("key", c.key,
           "Rays gather at a node, or at a block of memory, with traversal: ordered: a packet then names the block, a "
           "visit reads all of it, and each ray is tested with its own node there, which its owner keeps.")
      .only(EngineKind::kCycle, "simulated memory", CollectionKey::kBlock);
  v.field("block_bytes", c.block_bytes, IntRange{64, 1 << 20}, "bytes",
          "The blocks of memory by which rays gather, with key: block. A node belongs to the block in which it "
          "begins.");
  v.choice("policy", c.policy, "The rule that chooses the collection that is tested next.");
  v.choice("select", c.select, "Full collections are tested first, or the policy alone decides.");
  v.choice(
       "partial", c.partial,
       "A collection that is not ready may go when its resource has nothing else to do (idle), already when the work "
       "before it ends within a memory latency (ahead), or when it has waited for a time (after). The native engine, "
       "which has no clock, takes ahead as idle.")
      .relax("issue_rule", c.partial == Partial::kAhead ? Partial::kIdle : Partial::kAhead, Relaxed{.times = 0})
      .only(EngineKind::kCycle, "clock for collections that wait", Partial::kAfter);
  v.field("partial_after_cycles", c.partial_after_cycles, IntRange{1, 1'000'000'000}, "cycles",
          "The time that a collection waits to be filled, with partial: after.");
  v.field("grouped", c.grouped, "",
          "A packet of a collection that is not ready is filled up with the rays of the next such collections, each of "
          "which then goes through its own treelet; with bvh.treelets.");
  v.field("sort_ids_per_cycle", c.sort_ids_per_cycle, IntRange{0, 1024}, "ray IDs/cycle",
          "The ray IDs that a resource sorts by what comes next, and appends to collections, in a cycle. 0: as many as "
          "come.")
      .relax("sorting", Better::kTwice)
      .only(EngineKind::kCycle, "clock for the sorting of ray IDs");
  v.choice("home", c.home, "The resource that keeps the collections of a packet's hits.");
  v.field("capacity", c.capacity, IntRange{1, 1 << 30}, "ray IDs per resource",
          "The storage for collections. A ray takes one of them with traversal: ordered; otherwise collections take "
          "blocks of packets.rays. Without this key it is made as large as the reserve of when_full needs for the "
          "tree, if that is more than the default.")
      .relax("collection_storage", Better::kTwice, Relaxed{.times = kStorageTimes});
  v.choice("when_full", c.when_full,
           "When the storage is full, a resource keeps a reserve and holds new rays back, or it spills to memory.");
}

}  // namespace config
}  // namespace carousel
