#pragma once

#include <cstdint>
#include <string>

#include "core/config/fields/engine_kind.h"
#include "core/config/fields/field.h"

namespace carousel {

struct BvhConfig {
  std::int64_t width = 8;
  std::int64_t leaf_triangles = 4;
  std::int64_t treelet_triangles = 2048;
  struct Treelets {
    std::int64_t bytes = 0;
  } treelets;
  struct Micromaps {
    enum class States { kNone, kTwo, kFour } states = States::kNone;
    std::int64_t level = 4;
  } micromaps;
  enum class Elements { kBoxes, kSpheres, kOrientedBoxes } elements = Elements::kBoxes;
  std::int64_t mixed_triangles = 0;
  enum class Storage { kFull, kQuantised, kQuantised12 } storage = Storage::kFull;
  enum class Leaves { kTriangles, kStrips, kBlocks } leaves = Leaves::kTriangles;
  std::int64_t top_triangles = 0;
  std::int64_t levels = 2;
  enum class Builder { kSah, kSpatial, kOctree, kKd } builder = Builder::kSah;
  double duplicates = 0.3;
  enum class Merge { kNone, kWorld } merge = Merge::kNone;
  enum class Quality { kFast, kHigh } quality = Quality::kFast;
  std::string file;  ///< of trees; empty: they are built here
};

template <>
inline constexpr auto kEnumNames<BvhConfig::Elements> = [] {
  using enum BvhConfig::Elements;
  return names<BvhConfig::Elements>({{kBoxes, "boxes"}, {kSpheres, "spheres"}, {kOrientedBoxes, "oriented_boxes"}});
}();

template <>
inline constexpr auto kEnumNames<BvhConfig::Micromaps::States> = [] {
  using enum BvhConfig::Micromaps::States;
  return names<BvhConfig::Micromaps::States>({{kNone, "none"}, {kTwo, "two"}, {kFour, "four"}});
}();

template <>
inline constexpr auto kEnumNames<BvhConfig::Storage> = [] {
  using enum BvhConfig::Storage;
  return names<BvhConfig::Storage>({{kFull, "full"}, {kQuantised, "quantised"}, {kQuantised12, "quantised_12"}});
}();

template <>
inline constexpr auto kEnumNames<BvhConfig::Leaves> = [] {
  using enum BvhConfig::Leaves;
  return names<BvhConfig::Leaves>({{kTriangles, "triangles"}, {kStrips, "strips"}, {kBlocks, "blocks"}});
}();

template <>
inline constexpr auto kEnumNames<BvhConfig::Builder> = [] {
  using enum BvhConfig::Builder;
  return names<BvhConfig::Builder>({{kSah, "sah"}, {kSpatial, "spatial"}, {kOctree, "octree"}, {kKd, "kd"}});
}();

template <>
inline constexpr auto kEnumNames<BvhConfig::Merge> = [] {
  using enum BvhConfig::Merge;
  return names<BvhConfig::Merge>({{kNone, "none"}, {kWorld, "world"}});
}();

template <>
inline constexpr auto kEnumNames<BvhConfig::Quality> = [] {
  using enum BvhConfig::Quality;
  return names<BvhConfig::Quality>({{kFast, "fast"}, {kHigh, "high"}});
}();

/// Bits of a plane of a node's boxes; 0 where planes are floats.
constexpr int plane_bits(BvhConfig::Storage storage) {
  using enum BvhConfig::Storage;
  return storage == kQuantised ? 8 : storage == kQuantised12 ? 12 : 0;
}
constexpr bool is_quantised(BvhConfig::Storage storage) {
  return plane_bits(storage) > 0;
}

namespace config {

template <class V>
void describe(V& v, BvhConfig::Treelets& c) {
  v.field("bytes", c.bytes, IntRange{0, 1 << 20}, "bytes",
          "The whole tree is cut into connected pieces of at most this size, stored one after another, and rays gather "
          "at pieces: a visit loads a piece once and takes its rays through it depth first. A node or leaf that is "
          "larger is a piece by itself. With 0 rays gather at nodes.");
}

template <class V>
void describe(V& v, BvhConfig::Micromaps& c) {
  v.choice(
      "states", c.states,
      "The states of a micro-triangle: with four also unknown, for which the any-hit call decides; with two opaque "
      "or transparent only, so that a triangle has a micromap only where all of its micro-triangles are known. "
      "With none there are no micromaps.");
  v.field("level", c.level, IntRange{0, 6}, "levels",
          "How often a triangle is divided into four, so that it has 4^level micro-triangles.");
}

template <class V>
void describe(V& v, BvhConfig& c) {
  v.field("width", c.width, IntRange{2, 8}, "children", "The largest number of children of an inner node.");
  v.field("leaf_triangles", c.leaf_triangles, IntRange{1, 16}, "triangles",
          "The largest number of triangles of a leaf.");
  v.field("treelet_triangles", c.treelet_triangles, IntRange{1, 1 << 24}, "triangles",
          "The largest size of the subtrees that traversal: treelet crosses in one visit.");
  v.section("treelets", c.treelets, "Pieces of the whole tree.");
  v.choice("elements", c.elements,
           "The children of a node are bounded by boxes along the axes, by spheres, or by boxes that are turned.");
  v.field(
      "mixed_triangles", c.mixed_triangles, IntRange{0, 16}, "triangles",
      "Leaves of at most this size have no box; their triangles are tested with the other children of their parent. "
      "With 0 there are none.");
  v.choice(
      "storage", c.storage,
      "Nodes hold their children's boxes as floats, or in 8 bits a plane, outward; these have 64 bytes up to a width "
      "of 6, and 80 above. With quantised_12 a plane has 12 bits, and a node 128 bytes.");
  v.choice("leaves", c.leaves,
           "Leaves hold three vertices for each triangle, or strips of triangles that share vertices; or they stand in "
           "compressed blocks of 128 bytes, which a unit decodes (docs/how-it-works/memory.md).")
      .only(EngineKind::kCycle, "simulated memory", BvhConfig::Leaves::kStrips, BvhConfig::Leaves::kBlocks);
  v.field(
      "top_triangles", c.top_triangles, IntRange{0, 16}, "triangles",
      "A mesh that stands in the world without a transform and is one leaf of at most this size has no structure of "
      "its "
      "own; its triangles are tested with the other children of their parent in the top level. With 0 there are none.");
  v.field("levels", c.levels, IntRange{2, 8}, "levels",
          "The largest number of structures that a ray is in one below another: the top level, groups of instances "
          "within groups, and a mesh. With 2 every instance is in the top level.");
  v.choice("builder", c.builder,
           "Meshes are divided by their triangles alone, or also by planes in space, which the boxes of triangles on "
           "both sides are cut at: where that is better, at the middles of an octree's cells, or at the best planes of "
           "a kd-tree.");
  v.field("duplicates", c.duplicates, RealRange{0, 16}, "references/triangle",
          "How often planes in space cut at most, for each triangle of a mesh; what then is left is divided by its "
          "triangles alone.");
  v.choice("merge", c.merge,
           "Each mesh has a structure of its own; or those that stand in the world once, without a transform, have one "
           "together, so that a ray visits no node twice where they overlap.");
  v.choice(
      "quality", c.quality,
      "Meshes are divided once, from the top; or subtrees are then moved to where the areas of all boxes add up to "
      "less, which takes several times as long to build, and less to traverse where triangles are long.");
  v.section("micromaps", c.micromaps,
            "Opacity micromaps of the triangles that are not opaque, made from their textures and stored with them.");
  v.field("file", c.file, "",
          "A file of trees over the meshes, which takes the place of building them (docs/how-it-works/builders.md). "
          "Its path is "
          "relative as that of scene.file is. The top level is built as ever.");
}

}  // namespace config
}  // namespace carousel
