// A block of triangles at every level of accuracy.triangle: which of them the kernel hits, and what of that is a hit
// as section 3 of the design defines it.
#if defined(CAROUSEL_ACCEL_TRIANGLE_BLOCK_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef CAROUSEL_ACCEL_TRIANGLE_BLOCK_INL_H_
#undef CAROUSEL_ACCEL_TRIANGLE_BLOCK_INL_H_
#else
#define CAROUSEL_ACCEL_TRIANGLE_BLOCK_INL_H_
#endif

#include <algorithm>
#include <array>
#include <bit>
#include <limits>

#include <hwy/highway.h>

#include "accel/exact/exact_triangle.h"
#include "accel/primitive/has_non_opaque.h"
#include "accel/primitive/local_ray.h"
#include "accel/primitive/moller_trumbore-inl.h"
#include "accel/primitive/own_boxes-inl.h"
#include "accel/primitive/precise_crossing-inl.h"
#include "accel/primitive/sphere_hit.h"
#include "accel/primitive/watertight-inl.h"
#include "accel/structure/node.h"

HWY_BEFORE_NAMESPACE();
namespace carousel::accel::HWY_NAMESPACE {

/// A kernel's answer for a block: bit l of `inside` is set if the ray's line crosses triangle l.
template <class T>
struct Crossings {
  std::uint32_t inside = 0;
  alignas(sizeof(T) * kBlockTriangles) T t[kBlockTriangles], second[kBlockTriangles], third[kBlockTriangles];
};

/// Lowers `hit` to a crossing of the triangle in lane `l`, if its (t', instance, primitive) is smaller and nothing
/// lets the ray pass: t' also counts the entries of the triangle's own box and of the instance's world box.
template <class Slab>
HWY_INLINE bool lower(const Accel& accel, const TriangleBlock& block, std::size_t l, const Hit& crossing, float entry,
                      const LocalRay<Slab>& ray, Hit& hit) {
  Hit found = crossing;
  found.t = entry > found.t ? entry : found.t;
  found.t = ray.instance_entry > found.t ? ray.instance_entry : found.t;
  found.instance = ray.instance;
  found.primitive = block.primitive[l] & kPrimitiveMask;
  if (HWY_UNLIKELY(ray.instance == kNoInstance)) {
    const MergedMeshes::Name name = accel.merged.name(found.primitive);
    found.instance = name.instance;
    found.primitive = name.primitive;
  }
  if (!closer(found.t, found.instance, found.primitive, hit)) return false;
  const std::uint32_t calls_any_hit = block.primitive[l] & kNonOpaqueBit;
  if (HWY_UNLIKELY((calls_any_hit | (ray.record->tag.flags & kFlagsThatDecide)) != 0) &&
      !triangle_accepts(accel, calls_any_hit != 0, corners(block, l), ray, found))
    return false;
  hit = found;
  return true;
}

/// True if a crossing at `t` is a hit of the ray no farther than `farthest`. Negated comparisons also turn NaN away.
template <class Slab>
HWY_INLINE bool in_range(float t, const LocalRay<Slab>& ray, float farthest) {
  return t >= ray.slab.tmin && t <= std::numeric_limits<float>::max() && t <= farthest;
}

/// Tells a ray that looks for several hits of those among the crossings that lie behind the ends of their boxes.
/// `distance(l)` is that of a crossing.
template <class T, class Slab, class Distance>
HWY_INLINE void note_strays(const TriangleBlock& block, const Crossings<T>& crossings, const OwnBoxes<Slab>& boxes,
                            const LocalRay<Slab>& ray, const Distance& distance) {
  NearestRay* const nearest = nearest_of(*ray.record);
  if (HWY_LIKELY(nearest == nullptr) || !nearest->fears_strays()) return;
  for (std::uint32_t inside = crossings.inside; inside != 0; inside &= inside - 1) {
    const auto l = static_cast<std::size_t>(std::countr_zero(inside));
    float entry;
    if (!boxes.enters(l, kInfinity, entry)) continue;
    note_stray(*nearest, ray, box_of(corners(block, l)), distance(l), entry);
  }
}

/// lower() for all triangles of `block` that are crossed. True when the hit changed.
template <class T, class Slab>
HWY_INLINE bool update_closest(const Accel& accel, const TriangleBlock& block, const Crossings<T>& crossings,
                               const LocalRay<Slab>& ray, Hit& hit) {
  if (crossings.inside == 0) return false;
  const OwnBoxes<Slab> boxes(ray.slab, block);
  note_strays(block, crossings, boxes, ray, [&](std::size_t l) { return static_cast<float>(crossings.t[l]); });
  bool changed = false;
  for (std::uint32_t inside = crossings.inside; inside != 0; inside &= inside - 1) {
    const auto l = static_cast<std::size_t>(std::countr_zero(inside));
    const Hit found{static_cast<float>(crossings.t[l]), static_cast<float>(crossings.second[l]),
                    static_cast<float>(crossings.third[l]), 0, 0};
    if (!in_range(found.t, ray, hit.t)) continue;
    float entry;
    if (boxes.enters(l, hit.t, entry)) changed |= lower(accel, block, l, found, entry, ray, hit);
  }
  return changed;
}

/// True if the ray enters the box of a triangle in `inside` before tmax.
template <class Slab>
HWY_INLINE bool enters_any(const OwnBoxes<Slab>& boxes, std::uint32_t inside, float tmax) {
  bool any = false;
  for (; inside != 0; inside &= inside - 1) {
    float entry;
    any |= boxes.enters(static_cast<std::size_t>(std::countr_zero(inside)), tmax, entry);
  }
  return any;
}

/// As update_closest(), for crossings that have been decided in float. Crossings whose box may hold the closest hit
/// compete with distances and weights computed in double. A hit that the float puts ahead of the ray's start stays a
/// hit, at the start or at the largest float if need be: the rounding that moved it there has moved the surface that
/// the exact ray meets instead.
template <class Slab>
HWY_NOINLINE bool update_closest_precisely(const Accel& accel, const TriangleBlock& block,
                                           const Crossings<float>& crossings, const LocalRay<Slab>& ray, Hit& hit) {
  const OwnBoxes<Slab> boxes(ray.slab, block);
  if (nearest_of(*ray.record) == nullptr && !enters_any(boxes, crossings.inside, hit.t)) return false;
  const PreciseCrossings precise(ray.triangle.watertight, block);
  note_strays(block, crossings, boxes, ray, [&](std::size_t l) {
    Hit found;
    return precise.get(l, found) ? found.t : crossings.t[l];
  });
  bool changed = false;
  for (std::uint32_t inside = crossings.inside; inside != 0; inside &= inside - 1) {
    const auto l = static_cast<std::size_t>(std::countr_zero(inside));
    const float rounded = crossings.t[l];
    float entry;
    if (!boxes.enters(l, hit.t, entry)) continue;
    ++ray.counts->refined;
    Hit found;
    if (!precise.get(l, found)) found = {rounded, crossings.second[l], crossings.third[l], 0, 0};
    if (HWY_UNLIKELY(!in_range(found.t, ray, kInfinity)) && in_range(rounded, ray, kInfinity))
      found.t = std::clamp(found.t, ray.slab.tmin, std::numeric_limits<float>::max());
    if (in_range(found.t, ray, hit.t)) changed |= lower(accel, block, l, found, entry, ray, hit);
  }
  return changed;
}

// Each tests the triangles of `block` that `lanes` selects.

template <class T>
HWY_INLINE Crossings<T> watertight_crossings(const TriangleBlock& block, const WatertightRay<T>& ray,
                                             std::uint32_t lanes) {
  const hn::CappedTag<T, kBlockTriangles> d;
  Crossings<T> c;
  for (std::size_t i = 0; i < kBlockTriangles; i += hn::MaxLanes(d))
    c.inside |= watertight_lanes(d, block, i, ray, c.t + i, c.second + i, c.third + i) << i;
  c.inside &= lanes & ((1u << kBlockTriangles) - 1);
  return c;
}

template <class Slab>
HWY_INLINE bool watertight_block(const Accel& accel, const TriangleBlock& block, std::uint32_t lanes,
                                 const LocalRay<Slab>& ray, Hit& hit) {
  const Crossings<float> c = watertight_crossings(block, ray.triangle.watertight, lanes);
  return c.inside != 0 && update_closest_precisely(accel, block, c, ray, hit);
}

template <class Slab>
HWY_INLINE bool double_block(const Accel& accel, const TriangleBlock& block, std::uint32_t lanes,
                             const LocalRay<Slab>& ray, Hit& hit) {
  return update_closest(accel, block, watertight_crossings(block, ray.triangle.watertight_double, lanes), ray, hit);
}

template <class Slab>
HWY_INLINE bool moller_trumbore_block(const Accel& accel, const TriangleBlock& block, std::uint32_t lanes,
                                      const LocalRay<Slab>& ray, Hit& hit) {
  const hn::CappedTag<float, kBlockTriangles> d;
  Crossings<float> c;
  for (std::size_t i = 0; i < kBlockTriangles; i += hn::MaxLanes(d))
    c.inside |= moller_trumbore_lanes(d, block, i, ray.triangle.line, c.t + i, c.second + i, c.third + i) << i;
  c.inside &= lanes & ((1u << kBlockTriangles) - 1);
  return update_closest(accel, block, c, ray, hit);
}

/// The triangle's own box, which a hit has to pass anyway, spares most of them the exact test.
template <class Slab>
HWY_INLINE bool exact_block(const Accel& accel, const TriangleBlock& block, std::uint32_t lanes,
                            const LocalRay<Slab>& ray, Hit& hit) {
  Crossings<float> c;
  const OwnBoxes<Slab> boxes(ray.slab, block);
  for (std::size_t l = 0; l < kBlockTriangles; ++l) {
    float entry;
    if (!(lanes >> l & 1) || !boxes.enters(l, hit.t, entry)) continue;
    NearestCrossing crossing;
    if (!exact_triangle(ray.triangle.line, corners(block, l), crossing)) continue;
    c.t[l] = crossing.t, c.second[l] = crossing.u, c.third[l] = crossing.v;
    c.inside |= 1u << l;
  }
  return update_closest(accel, block, c, ray, hit);
}

/// The blocks of a leaf, of whose triangles `lanes` selects some; `test` is one of the above.
template <class Test>
HWY_INLINE bool each_block(const Accel& accel, NodeRef leaf, std::uint32_t lanes, const Test& test) {
  bool changed = false;
  for (std::uint32_t b = 0; b < leaf.blocks(); ++b, lanes >>= kBlockTriangles)
    changed |= test(accel.blocks[leaf.first_block() + b], lanes);
  return changed;
}

/// The procedural primitives of a leaf likewise.
template <class Slab>
HWY_INLINE bool test_procedurals(const Accel& accel, NodeRef leaf, std::uint32_t lanes, const LocalRay<Slab>& ray,
                                 Hit& hit) {
  bool changed = false;
  for (std::uint32_t i = 0; i < leaf.triangles(); ++i)
    if (lanes >> i & 1)
      changed |= lower_by_procedural(accel, accel.blocks[leaf.first_block() + i / kBlockTriangles], i % kBlockTriangles,
                                     ray, hit);
  return changed;
}

/// Kept apart from test_leaf(), whose registers and code are the watertight kernel's.
template <class Slab>
HWY_NOINLINE bool test_leaf_otherwise(const Accel& accel, NodeRef leaf, std::uint32_t lanes, const LocalRay<Slab>& ray,
                                      Hit& hit) {
  if (leaf.is_procedural()) return test_procedurals(accel, leaf, lanes, ray, hit);
  const auto each = [&](const auto& test) HWY_ATTR { return each_block(accel, leaf, lanes, test); };
  switch (accel.accuracy.triangle) {
    case TriangleLevel::kFast:
      return each([&](const TriangleBlock& block, std::uint32_t some)
                      HWY_ATTR { return moller_trumbore_block(accel, block, some, ray, hit); });
    case TriangleLevel::kDouble:
      return each([&](const TriangleBlock& block, std::uint32_t some)
                      HWY_ATTR { return double_block(accel, block, some, ray, hit); });
    case TriangleLevel::kExact:
      return each([&](const TriangleBlock& block, std::uint32_t some)
                      HWY_ATTR { return exact_block(accel, block, some, ray, hit); });
    case TriangleLevel::kWatertight:
      break;
  }
  return false;
}

/// Tests the triangles, or procedural primitives, of `leaf` that `lanes` selects and lowers `hit`; true when it
/// changed. Not inlined: its registers would push the traversal's own into memory.
template <class Slab>
HWY_NOINLINE bool test_leaf(const Accel& accel, NodeRef leaf, std::uint32_t lanes, const LocalRay<Slab>& ray,
                            Hit& hit) {
  if (HWY_UNLIKELY(accel.accuracy.triangle != TriangleLevel::kWatertight || leaf.is_procedural()))
    return test_leaf_otherwise(accel, leaf, lanes, ray, hit);
  return each_block(accel, leaf, lanes, [&](const TriangleBlock& block, std::uint32_t some) HWY_ATTR {
    return watertight_block(accel, block, some, ray, hit);
  });
}

}  // namespace carousel::accel::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // per-target include guard
