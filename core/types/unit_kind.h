#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "core/statistics/intersection_counts.h"

namespace carousel {

// A new kind of unit takes three places, here `curve`, which tests rays against curves:
//   1. a counter `curve` in core/statistics/intersection_counts.h, with its row and its term in tests();
//   2. in this file, an enumerator and a row of the table:
//        {UnitKind::kCurve, "curve", "curve", "curve_tests", "Units that test a ray against a curve.", 1, 1, 8,
//         &IntersectionCounts::curve, Stage::kPrimitive, Shown::kAlways},
//   3. the test itself, which counts: `counts.curve += ...`.
// Configuration, cycle engine, faults, what-ifs, bounds and report follow from the table. A kind of another stage than
// kPrimitive also needs its place in the order of the tests, in ringbus/cycle/testers/tester.h.

/// A kind of test unit that a resource has.
enum class UnitKind : std::uint8_t {
  kBox,
  kTriangle,
  kPlane,
  kBundle,
  kTransform,
  kProcedural,
  kAnyHit,
  kMicromap,
  kHitBuffer,
  kDecoder,
  kReciprocal
};

/// The place of a kind in the order of a visit's tests.
enum class Stage : std::uint8_t {
  kBundle,     ///< bundles of rays first, and the divisions that their tests need
  kTransform,  ///< then the rays that are left go to model space
  kNode,       ///< at a node, boxes and planes
  kPrimitive,  ///< at a leaf, primitives of all kinds side by side
  kMicromap,   ///< then the opacity micromaps of the triangles that are hit
  kAnyHit,     ///< then the opacity of the primitives that are hit
  kHitBuffer,  ///< then hits are put into the sorted buffers of rays
  kDecode,     ///< ahead of primitives, and beside transforms: compressed leaves
};

struct UnitKindRow {
  UnitKind kind;
  std::string_view key;  ///< below `testers` of the configuration
  const char* name;      ///< below `units` of a resource in the report
  const char* work;      ///< its class of parts in `bottleneck` and `bound` of the report
  const char* meaning;   ///< a sentence
  std::int64_t units, interval_cycles, latency_cycles;  ///< defaults of the configuration
  std::uint64_t IntersectionCounts::*tests;             ///< the counter of its tests
  Stage stage;
  Shown shown;
};

/// The one table of the kinds, in the order of the enum and of the configuration.
inline constexpr auto kUnitKinds = std::to_array<UnitKindRow>({
    {UnitKind::kBox, "box", "box", "box_tests", "Units that test a ray against a box.", 4, 1, 13,
     &IntersectionCounts::box, Stage::kNode, Shown::kAlways},
    {UnitKind::kTriangle, "triangle", "triangle", "triangle_tests", "Units that test a ray against a triangle.", 1, 1,
     37, &IntersectionCounts::triangle, Stage::kPrimitive, Shown::kAlways},
    {UnitKind::kPlane, "plane", "plane", "plane_tests", "Units that test a ray against a cull plane.", 4, 1, 22,
     &IntersectionCounts::plane, Stage::kNode, Shown::kCullPlanes},
    {UnitKind::kBundle, "bundle", "bundle", "bundle_tests",
     "Units that test a bundle of rays against a box or the box of a primitive.", 1, 1, 13, &IntersectionCounts::bundle,
     Stage::kBundle, Shown::kBundles},
    {UnitKind::kTransform, "transform", "transform", "transforms",
     "Units that bring a ray from world space to model space.", 1, 1, 5, &IntersectionCounts::transforms,
     Stage::kTransform, Shown::kAlways},
    {UnitKind::kProcedural, "procedural", "procedural", "procedural_tests",
     "Units that test a ray against a procedural primitive.", 1, 1, 37, &IntersectionCounts::procedural,
     Stage::kPrimitive, Shown::kProcedural},
    {UnitKind::kAnyHit, "any_hit_unit", "any_hit", "any_hit_lookups",
     "Units that decide if a non-opaque primitive is hit, with any_hit: inline.", 1, 1, 8,
     &IntersectionCounts::any_hit_calls, Stage::kAnyHit, Shown::kAnyHitUnit},
    {UnitKind::kMicromap, "micromap_unit", "micromap", "micromap_lookups",
     "Units that look a hit up in the opacity micromap of its triangle.", 1, 1, 3,
     &IntersectionCounts::micromap_lookups, Stage::kMicromap, Shown::kMicromaps},
    {UnitKind::kHitBuffer, "hit_buffer", "hit_buffer", "hit_buffer_steps",
     "Units that put hits into the sorted buffers of rays, a comparison and a shift a step.", 1, 1, 1,
     &IntersectionCounts::buffer_steps, Stage::kHitBuffer, Shown::kNearest},
    {UnitKind::kDecoder, "decoder", "decoder", "decoded_blocks",
     "Units that decode blocks of triangles, with bvh.leaves: blocks. Each test is a block.", 1, 4, 8,
     &IntersectionCounts::decoded, Stage::kDecode, Shown::kBlocks},
    {UnitKind::kReciprocal, "reciprocal", "reciprocal", "reciprocals",
     "Units that divide for bundles: for their directions, ahead of tests by intervals, and for the distance of a box, "
     "behind tests by silhouettes.",
     1, 1, 17, &IntersectionCounts::reciprocals, Stage::kBundle, Shown::kBundles},
});

constexpr std::size_t unit_index(UnitKind kind) {
  return static_cast<std::size_t>(kind);
}

constexpr const UnitKindRow& unit_row(UnitKind kind) {
  return kUnitKinds[unit_index(kind)];
}

static_assert([] {
  for (std::size_t i = 0; i < kUnitKinds.size(); ++i)
    if (unit_index(kUnitKinds[i].kind) != i) return false;
  return true;
}());

/// One T for each kind of unit. A loop over it gives each kind with its T: `for (auto [kind, value] : per_unit)`.
template <class T>
class PerUnit {
 public:
  constexpr T& operator[](UnitKind kind) { return values_[unit_index(kind)]; }
  constexpr const T& operator[](UnitKind kind) const { return values_[unit_index(kind)]; }

  template <class Value>
  struct Item {
    UnitKind kind;
    Value& value;
  };
  template <class Value>
  class Iterator {
   public:
    constexpr Iterator(Value* values, std::size_t index) : values_(values), index_(index) {}
    constexpr Item<Value> operator*() const { return {kUnitKinds[index_].kind, values_[index_]}; }
    constexpr Iterator& operator++() {
      ++index_;
      return *this;
    }
    constexpr bool operator!=(const Iterator& other) const { return index_ != other.index_; }

   private:
    Value* values_;
    std::size_t index_;
  };
  constexpr Iterator<T> begin() { return {values_.data(), 0}; }
  constexpr Iterator<T> end() { return {values_.data(), values_.size()}; }
  constexpr Iterator<const T> begin() const { return {values_.data(), 0}; }
  constexpr Iterator<const T> end() const { return {values_.data(), values_.size()}; }

  friend constexpr bool operator==(const PerUnit&, const PerUnit&) = default;

 private:
  std::array<T, kUnitKinds.size()> values_{};
};

}  // namespace carousel
