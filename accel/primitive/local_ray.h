#pragma once

#include <cstdint>
#include <new>
#include <vector>

#include "accel/box/double_slab.h"
#include "accel/box/slab.h"
#include "accel/primitive/watertight.h"
#include "accel/structure/accel.h"
#include "core/config/fields/accuracy.h"
#include "core/statistics/intersection_counts.h"
#include "core/types/any_hit.h"
#include "core/types/ray.h"

namespace carousel::accel {

/// The triangle test's data of a ray. `accuracy.triangle` decides which member is used.
union TriangleRay {
  WatertightRay<float> watertight;
  WatertightRay<double> watertight_double;
  Ray line;  ///< fast and exact: as it is

  [[gnu::always_inline]] TriangleRay(const Ray& ray, TriangleLevel level) {
    if (level == TriangleLevel::kWatertight) [[likely]]
      new (&watertight) WatertightRay<float>(ray);
    else if (level == TriangleLevel::kDouble)
      new (&watertight_double) WatertightRay<double>(ray);
    else
      new (&line) Ray(ray);
  }
};

/// All that testing needs of a ray, above the instances or below one: in world or in model space. Built in its
/// place: copying what was just written piece by piece would stall on the stores. Slab is SlabRay, or DoubleSlabRay
/// for accuracy.box: double.
template <class Slab>
struct LocalRay {
  Slab slab;
  TriangleRay triangle;
  std::uint32_t instance;
  float instance_entry;  ///< distance at which the ray enters the instance's world box
  // For tests of few configurations: planes, procedural primitives, non-opaque materials.
  Vec3 origin, direction;
  const RayRecord* record;  ///< the ray in world space, and what it wants
  IntersectionCounts* counts;
  std::vector<AnyHitCall>* calls = nullptr;  ///< where any-hit calls are noted; null: nowhere

  [[gnu::always_inline]] LocalRay(const AccuracyConfig& accuracy, const Ray& ray, std::uint32_t i, float entry,
                                  const RayRecord& of, IntersectionCounts& total)
      : slab(ray, far_widening(accuracy.box)),
        triangle(ray, accuracy.triangle),
        instance(i),
        instance_entry(entry),
        origin(ray.origin),
        direction(ray.direction),
        record(&of),
        counts(&total) {}
};

/// Storage for a LocalRay to be built in.
template <class Slab>
union FrameStorage {
  LocalRay<Slab> ray;
  FrameStorage() {}
};

/// A frame of `record`'s ray, given in world space, to test shapes of `instance`; kNoInstance for the world itself. An
/// instance without a transform is tested in world space, and its world box is the union of the boxes below it:
/// entered no later than any of them, it decides nothing.
template <class Slab>
[[gnu::always_inline]] inline void enter_frame(const Accel& accel, std::uint32_t instance, const RayRecord& record,
                                               LocalRay<Slab>* frame, IntersectionCounts& counts) {
  const Ray& ray = record.ray;
  if (instance == kNoInstance || accel.instances[instance].transform.identity) {
    new (frame) LocalRay<Slab>(accel.accuracy, ray, instance, ray.tmin, record, counts);
    return;
  }
  const InstanceNode& node = accel.instances[instance];
  float entry;
  slab(Slab(ray, far_widening(accel.accuracy.box)), node.world, kInfinity, entry);
  ++counts.transforms;
  counts.transforms_in_double += node.transform.promoted;
  new (frame) LocalRay<Slab>(accel.accuracy, node.transform.to_model(ray), instance, entry, record, counts);
}

}  // namespace carousel::accel
