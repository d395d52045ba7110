#pragma once

#include <cstdint>

#include "core/config/fields/field.h"

namespace carousel {

struct CullPlanesConfig {
  std::int64_t count = 0;
  enum class Nodes { kLeaves, kInner, kAll } nodes = Nodes::kLeaves;
  bool shared_normals = false;
  enum class Fit { kVertices, kBoxes } fit = Fit::kVertices;
  enum class Order { kBoxFirst, kPlanesFirst } order = Order::kBoxFirst;
  enum class Levels { kBlas, kTlas, kAll } levels = Levels::kBlas;
};

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
void describe(V& v, CullPlanesConfig& c) {
  v.field("count", c.count, IntRange{0, 8}, "planes per child",
          "The largest number of cull planes of a child. With 0 there are none.");
  v.choice("nodes", c.nodes, "The children that have planes.");
  v.field("shared_normals", c.shared_normals, "", "Siblings share the normals of their planes.");
  v.choice("fit", c.fit,
           "The planes of inner children and instances are moved up to vertices or to the boxes below; those of leaves "
           "always to vertices.");
  v.choice("levels", c.levels,
           "The nodes that have planes lie below the instances (blas), above them, where the leaves are instances "
           "(tlas), or both.");
  v.choice("order", c.order,
           "The planes of a child are tested after its box has been hit, or before its box, which then may need no "
           "test.");
}

}  // namespace config
}  // namespace carousel
