#pragma once

#include <cstdint>

#include "core/config/fields/engine_kind.h"
#include "core/config/fields/field.h"

namespace carousel {

struct BundlesConfig {
  std::int64_t size = 0;
  enum class Form { kInterval, kSilhouette } form = Form::kInterval;
  enum class Edges { kSerial, kParallel } edges = Edges::kSerial;
  enum class Order { kAllHitFirst, kAnyHitFirst, kParallel, kAllHitOnly, kAnyHitOnly } order = Order::kAllHitFirst;
  bool strict = false;
  enum class Lifetime { kPersistent, kReformed } lifetime = Lifetime::kPersistent;
  struct Builder {
    std::int64_t open = 16, rays_per_cycle = 2, age = 64;
    enum class Similarity { kGrowth, kSolidAngle, kComponentRange, kOriginBox } similarity = Similarity::kGrowth;
    enum class Measure { kAbsolute, kPercent } measure = Measure::kAbsolute;
    double threshold = 0.1;
    bool same_origin = false, same_signs = true;
  } builder;
  enum class Sources { kAll, kCamera, kShader } sources = Sources::kAll;
  enum class Split { kTester, kBuilder, kUntested } split = Split::kTester;
  std::int64_t min_rays = 2;
  struct SplitBelow {
    std::int64_t depth = 255;
    double box_size = 0;
  } split_below;
  struct SplitAbove {
    double spread = 0, silhouette_area = 0;
  } split_above;
  enum class AtInstances { kSplit, kRebound } at_instances = AtInstances::kSplit;
  enum class Leaf { kRays, kPrimitives } leaf = Leaf::kRays;
  enum class Hint { kIgnore, kObey } hint = Hint::kIgnore;
};

template <>
inline constexpr auto kEnumNames<BundlesConfig::Form> = [] {
  using enum BundlesConfig::Form;
  return names<BundlesConfig::Form>({{kInterval, "interval"}, {kSilhouette, "silhouette"}});
}();

template <>
inline constexpr auto kEnumNames<BundlesConfig::Edges> = [] {
  using enum BundlesConfig::Edges;
  return names<BundlesConfig::Edges>({{kSerial, "serial"}, {kParallel, "parallel"}});
}();

template <>
inline constexpr auto kEnumNames<BundlesConfig::Order> = [] {
  using enum BundlesConfig::Order;
  return names<BundlesConfig::Order>({{kAllHitFirst, "all_hit_first"},
                                      {kAnyHitFirst, "any_hit_first"},
                                      {kParallel, "parallel"},
                                      {kAllHitOnly, "all_hit_only"},
                                      {kAnyHitOnly, "any_hit_only"}});
}();

template <>
inline constexpr auto kEnumNames<BundlesConfig::Lifetime> = [] {
  using enum BundlesConfig::Lifetime;
  return names<BundlesConfig::Lifetime>({{kPersistent, "persistent"}, {kReformed, "reformed"}});
}();

template <>
inline constexpr auto kEnumNames<BundlesConfig::Builder::Similarity> = [] {
  using enum BundlesConfig::Builder::Similarity;
  return names<BundlesConfig::Builder::Similarity>({{kGrowth, "growth"},
                                                    {kSolidAngle, "solid_angle"},
                                                    {kComponentRange, "component_range"},
                                                    {kOriginBox, "origin_box"}});
}();

template <>
inline constexpr auto kEnumNames<BundlesConfig::Builder::Measure> = [] {
  using enum BundlesConfig::Builder::Measure;
  return names<BundlesConfig::Builder::Measure>({{kAbsolute, "absolute"}, {kPercent, "percent"}});
}();

template <>
inline constexpr auto kEnumNames<BundlesConfig::Sources> = [] {
  using enum BundlesConfig::Sources;
  return names<BundlesConfig::Sources>({{kAll, "all"}, {kCamera, "camera"}, {kShader, "shader"}});
}();

template <>
inline constexpr auto kEnumNames<BundlesConfig::Split> = [] {
  using enum BundlesConfig::Split;
  return names<BundlesConfig::Split>({{kTester, "tester"}, {kBuilder, "builder"}, {kUntested, "untested"}});
}();

template <>
inline constexpr auto kEnumNames<BundlesConfig::AtInstances> = [] {
  using enum BundlesConfig::AtInstances;
  return names<BundlesConfig::AtInstances>({{kSplit, "split"}, {kRebound, "rebound"}});
}();

template <>
inline constexpr auto kEnumNames<BundlesConfig::Leaf> = [] {
  using enum BundlesConfig::Leaf;
  return names<BundlesConfig::Leaf>({{kRays, "rays"}, {kPrimitives, "primitives"}});
}();

template <>
inline constexpr auto kEnumNames<BundlesConfig::Hint> = [] {
  using enum BundlesConfig::Hint;
  return names<BundlesConfig::Hint>({{kIgnore, "ignore"}, {kObey, "obey"}});
}();

namespace config {

template <class V>
void describe(V& v, BundlesConfig::Builder& c) {
  v.field("open", c.open, IntRange{1, 1024}, "bundles", "The number of bundles that still take rays.")
      .relax("bundles_open", Better::kTwice);
  v.field("rays_per_cycle", c.rays_per_cycle, IntRange{1, 1024}, "rays/cycle",
          "The number of rays that the builder reads.")
      .relax("bundle_builder", Better::kTwice);
  v.field("age", c.age, IntRange{1, 1'000'000}, "rays",
          "After so many further rays an open bundle is sent on as it is.");
  v.choice("similarity", c.similarity, "The size of a bundle that must stay small when a ray joins.");
  v.choice("measure", c.measure, "The threshold limits the size itself, or its growth by the ray.");
  v.field(
      "threshold", c.threshold, RealRange{0, 1e6}, "",
      "An absolute threshold is a part of the scene's size for origins, and of a unit vector for directions. One in "
      "percent is the growth.");
  v.field("same_origin", c.same_origin, "", "Only rays that start at the same point join.");
  v.field("same_signs", c.same_signs, "", "Only rays whose directions lie in the same octant join.");
}

template <class V>
void describe(V& v, BundlesConfig::SplitBelow& c) {
  v.field("depth", c.depth, IntRange{0, 255}, "strips", "Bundles split below this depth.");
  v.field("box_size", c.box_size, RealRange{0, 1}, "of the scene's size", "Bundles split at nodes smaller than this.");
}

template <class V>
void describe(V& v, BundlesConfig::SplitAbove& c) {
  v.field("spread", c.spread, RealRange{0, 2}, "of the longest component",
          "Bundles split if their directions differ by more along an axis. With 0 there is no limit.");
  v.field("silhouette_area", c.silhouette_area, RealRange{0, 1e9}, "of the node's mean face",
          "Bundles split if their cross-section at a node is larger. With 0 there is no limit.");
}

template <class V>
void describe(V& v, BundlesConfig& c) {
  v.field("size", c.size, IntRange{0, 64}, "rays",
          "The largest number of rays of a bundle. With 0 there are no bundles.");
  v.choice("form", c.form, "A bundle is tested by intervals of its rays or by the silhouette of the box.");
  v.choice("edges", c.edges, "The edges of a silhouette are tested one after another or at once.")
      .only(EngineKind::kCycle, "clock for parallel edges", BundlesConfig::Edges::kParallel);
  v.choice("order", c.order, "The order of the two tests of a bundle: all rays hit the box, and any ray hits it.");
  v.field("strict", c.strict, "", "A bundle goes down whole only if each of its rays surely hits the box.");
  v.choice("lifetime", c.lifetime, "Bundles stay together from node to node, or are formed anew at each node.");
  v.section("builder", c.builder, "The part that makes bundles of similar rays.");
  v.choice("sources", c.sources, "Bundles are made of all rays, of camera rays only, or of the shaders' rays only.");
  v.choice(
      "split", c.split,
      "The rays of a split bundle are tested one by one and go on alone, or are tested and go on in bundles that "
      "the builder makes of them, or go back to the builder untested and come to the same node in smaller bundles.");
  v.field("min_rays", c.min_rays, IntRange{2, 64}, "rays", "Bundles of fewer rays than this are not made.");
  v.section("split_below", c.split_below, "Places in the tree where bundles split, hit or not.");
  v.section("split_above", c.split_above, "Widths above which bundles split, hit or not.");
  v.choice("at_instances", c.at_instances,
           "At an instance with a transform a bundle splits, or its bounds are computed anew in model space.");
  v.choice(
      "leaf", c.leaf,
      "At a leaf each ray of a bundle is tested against each primitive, or the bundle is tested first, and its rays "
      "only against the primitives that one of them may hit.");
  v.choice("hint", c.hint,
           "The shaders mark rays that left by a wide lobe. Bundles ignore the mark, or leave such rays out.");
}

}  // namespace config
}  // namespace carousel
