#pragma once

#include <cstdint>

#include "core/config/fields/field.h"

namespace carousel {

struct CullPlanesConfig {
  std::int64_t count = 0;
  enum class Object { kPlanes, kOrientedBox, kSphere } object = Object::kPlanes;
  enum class Nodes { kLeaves, kInner, kAll } nodes = Nodes::kLeaves;
  bool shared_normals = false;
  enum class Fit { kVertices, kBoxes } fit = Fit::kVertices;
  enum class Order { kBoxFirst, kPlanesFirst } order = Order::kBoxFirst;
  enum class Levels { kBlas, kTlas, kAll } levels = Levels::kBlas;
  struct Depth {
    std::int64_t first = 0, last = 255;
  } depth{};
};

template <>
inline constexpr auto kEnumNames<CullPlanesConfig::Object> = [] {
  using enum CullPlanesConfig::Object;
  return names<CullPlanesConfig::Object>({{kPlanes, "planes"}, {kOrientedBox, "oriented_box"}, {kSphere, "sphere"}});
}();

template <>
inline constexpr auto kEnumNames<CullPlanesConfig::Nodes> = [] {
  using enum CullPlanesConfig::Nodes;
  return names<CullPlanesConfig::Nodes>({{kLeaves, "leaves"}, {kInner, "inner"}, {kAll, "all"}});
}();

template <>
inline constexpr auto kEnumNames<CullPlanesConfig::Fit> = [] {
  using enum CullPlanesConfig::Fit;
  return names<CullPlanesConfig::Fit>({{kVertices, "vertices"}, {kBoxes, "boxes"}});
}();

template <>
inline constexpr auto kEnumNames<CullPlanesConfig::Order> = [] {
  using enum CullPlanesConfig::Order;
  return names<CullPlanesConfig::Order>({{kBoxFirst, "box_first"}, {kPlanesFirst, "planes_first"}});
}();

template <>
inline constexpr auto kEnumNames<CullPlanesConfig::Levels> = [] {
  using enum CullPlanesConfig::Levels;
  return names<CullPlanesConfig::Levels>({{kBlas, "blas"}, {kTlas, "tlas"}, {kAll, "all"}});
}();

namespace config {

template <class V>
void describe(V& v, CullPlanesConfig::Depth& c) {
  v.field("first", c.first, IntRange{0, 255}, "nodes", "The least depth of a node whose children have planes.");
  v.field("last", c.last, IntRange{0, 255}, "nodes", "The greatest depth of a node whose children have planes.");
}

template <class V>
void describe(V& v, CullPlanesConfig& c) {
  v.field("count", c.count, IntRange{0, 8}, "planes per child",
          "The largest number of cull planes of a child; an oriented box has six, and there is one sphere. "
          "With 0 there are none.");
  v.choice("object", c.object,
           "The planes are chosen singly, or are the six faces of a box that is turned against the axes; or a sphere "
           "stands in place of a plane.");
  v.choice("nodes", c.nodes, "The children that have planes.");
  v.field("shared_normals", c.shared_normals, "", "Siblings share the normals of their planes.");
  v.choice("fit", c.fit,
           "The planes of inner children and instances are moved up to vertices or to the boxes below; those of leaves "
           "always to vertices.");
  v.choice("levels", c.levels,
           "The nodes that have planes lie below the instances (blas), above them, where the leaves are instances "
           "(tlas), or both.");
  v.section("depth", c.depth, "The depths of the nodes whose children have planes. The root of a tree has depth 0.");
  v.choice("order", c.order,
           "The planes of a child are tested after its box has been hit, or before its box, which then may need no "
           "test.");
}

}  // namespace config
}  // namespace carousel
