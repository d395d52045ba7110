#pragma once

#include <cstdint>

#include "core/config/fields/engine_kind.h"
#include "core/config/fields/field.h"

namespace carousel {

enum class PacketShapes { kStrip, kSingle };
template <>
inline constexpr auto kEnumNames<PacketShapes> = [] {
  using enum PacketShapes;
  return names<PacketShapes>({{kStrip, "strip"}, {kSingle, "single"}});
}();

enum class PacketCarry { kReference, kData };
template <>
inline constexpr auto kEnumNames<PacketCarry> = [] {
  using enum PacketCarry;
  return names<PacketCarry>({{kReference, "reference"}, {kData, "data"}});
}();

enum class PacketResults { kMask, kPerShape, kMessage, kImpliedOrder };
template <>
inline constexpr auto kEnumNames<PacketResults> = [] {
  using enum PacketResults;
  return names<PacketResults>(
      {{kMask, "mask"}, {kPerShape, "per_shape"}, {kMessage, "message"}, {kImpliedOrder, "implied_order"}});
}();

enum class MadePer { kParent, kChild };
template <>
inline constexpr auto kEnumNames<MadePer> = [] {
  using enum MadePer;
  return names<MadePer>({{kParent, "parent"}, {kChild, "child"}});
}();

struct PacketsConfig {
  std::int64_t rays = 32;
  PacketShapes shapes = PacketShapes::kStrip;
  PacketCarry carry = PacketCarry::kReference;
  PacketResults results = PacketResults::kMask;
  MadePer made_per = MadePer::kParent;
  std::int64_t ids_per_cycle = 16;
};

namespace config {

template <class V>
void describe(V& v, PacketsConfig& c) {
  v.field("rays", c.rays, IntRange{1, 1024}, "rays", "The largest number of ray IDs that a packet carries.");
  v.choice("shapes", c.shapes, "A packet carries all shapes below one node, or a single one.");
  v.choice("carry", c.carry, "A packet carries a reference to its shapes, or their data.")
      .only(EngineKind::kCycle, "packets that carry data", PacketCarry::kData);
  v.choice("results", c.results, "The way in which hits travel back to the owner of the packet.")
      .only(EngineKind::kCycle, "wire on which results could travel otherwise");
  v.choice("made_per", c.made_per,
           "Rays gather at the node whose children they are tested against, or at each child of a node that they hit, "
           "which has a collection and packets of its own, with shapes: single.");
  v.field("ids_per_cycle", c.ids_per_cycle, IntRange{1, 1024}, "ray IDs/cycle",
          "The number of a packet's ray IDs that a resource reads, to find its own rays or to gather hits.")
      .relax("dispatch", Better::kTwice);
}

}  // namespace config
}  // namespace carousel
