#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "accel/box/bundle.h"
#include "accel/box/slab.h"
#include "accel/certificate/adversarial_numbers.h"
#include "accel/structure/cull_plane.h"
#include "accel/structure/node.h"
#include "accel/traverse/ray_check.h"
#include "core/types/aabb.h"
#include "core/types/ray.h"

namespace carousel::accel {

inline constexpr Aabb kUnit{{-1, -1, -1}, {1, 1, 1}};

inline Ray ray(const Vec3& origin, const Vec3& direction, float end = kInfinity) {
  return {origin, 0, direction, end};
}

/// The record of these rays; the range of each ends at its tmax.
inline BundleRecord record_of(const std::vector<Ray>& rays) {
  BundleRecord record;
  for (const Ray& ray : rays) record.widen(ray, ray.tmax);
  record.count = static_cast<std::uint8_t>(rays.size());
  return record;
}

inline void set_child(Node& node, int lane, const Aabb& box) {
  for (int axis = 0; axis < 3; ++axis) {
    node.plane[axis][lane] = box.lo[axis];
    node.plane[axis + 3][lane] = box.hi[axis];
  }
  node.count = static_cast<std::uint8_t>(std::max<int>(node.count, lane + 1));
}

/// A bundle of 1, 4, 16 or 32 rays and some boxes, made to be hard to decide.
struct BundleCase {
  static constexpr int kBoxes = 4;
  std::vector<Ray> rays;
  Node node;
};

namespace bundle_case_detail {

template <class Random>
Vec3 aimed_at(const Aabb& box, Random& random) {
  Vec3 aim;
  for (int axis = 0; axis < 3; ++axis) {
    const std::uint32_t where = random.below(3);
    aim[axis] = where == 0 ? box.lo[axis] : where == 1 ? box.hi[axis] : random.uniform(box.lo[axis], box.hi[axis]);
  }
  return aim;
}

/// The box itself, or one that shares planes with it, some ulps off, flat, a point, or beside it.
template <class Random>
Aabb neighbour(Aabb box, float size, Random& random) {
  const int axis = static_cast<int>(random.below(3));
  switch (random.below(7)) {
    case 0:
      return box;
    case 1:
      box.hi[axis] = box.lo[axis];
      return box;
    case 2:
      box.lo[axis] = box.hi[axis];
      return box;
    case 3:
      return {box.hi, box.hi};
    case 4: {
      const Vec3 shift = random.in_box(Vec3{-size}, Vec3{size});
      return {box.lo + shift, box.hi + shift};
    }
    case 5:
      box.lo[axis] = nudged(box.lo[axis], 2, random);
      break;
    default:
      box.hi += random.in_box(Vec3{0}, Vec3{size});
      break;
  }
  Aabb out;
  out.extend(box.lo);
  out.extend(box.hi);
  return out;
}

}  // namespace bundle_case_detail

/// `reach` is that of the exponents of places, `pace` that of the time it takes to get there.
template <class Random>
BundleCase bundle_case(Random& random, int reach, int pace) {
  using namespace bundle_case_detail;
  BundleCase c;
  const float place = wild_power(random, -reach, reach), size = place * wild_power(random, -24, 2);
  const Vec3 centre = random.in_box(Vec3{-place}, Vec3{place});
  Aabb box;
  box.extend(random.below(8) ? centre + random.in_box(Vec3{-size}, Vec3{size}) : centre);
  box.extend(random.below(8) ? centre + random.in_box(Vec3{-size}, Vec3{size}) : centre);
  set_child(c.node, 0, box);
  for (int lane = 1; lane < BundleCase::kBoxes; ++lane) set_child(c.node, lane, neighbour(box, size, random));

  // The properties that all rays share.
  constexpr std::size_t kSizes[] = {1, 4, 16, 32};
  const std::size_t count = kSizes[random.below(4)];
  Vec3 eye = random.in_box(Vec3{-4 * place}, Vec3{4 * place});
  if (random.below(4) == 0) eye = centre + random.in_box(Vec3{-2 * size}, Vec3{2 * size});
  if (random.below(16) == 0) eye = random.in_box(box.lo, box.hi);
  Vec3 aim = aimed_at(box, random);
  for (int axis = 0; axis < 3; ++axis)
    if (random.below(8) == 0) eye[axis] = aim[axis];
  if (random.below(2)) aim += random.in_box(Vec3{-2 * size}, Vec3{2 * size});
  const std::uint32_t origins = random.below(4), aims = random.below(4), ends = random.below(4);
  const std::uint32_t zeros = random.below(8);
  const float apart = size * wild_power(random, -10, 2), spread = size * wild_power(random, -12, 2);
  const float speed = wild_power(random, -pace, pace);
  const bool unlike_speeds = random.below(8) == 0, both_ways = random.below(8) == 0;
  const int odd_axis = static_cast<int>(random.below(3));

  for (std::size_t i = 0; i < count; ++i) {
    Ray ray;
    ray.origin = eye;
    if (origins == 1) ray.origin = nudged(eye, 2, random);
    if (origins == 2) ray.origin += random.in_box(Vec3{-apart}, Vec3{apart});
    Vec3 to = aim;
    if (aims == 1) to += random.in_box(Vec3{-spread}, Vec3{spread});
    if (aims == 2) to = aimed_at(box, random);
    ray.direction = nudged(to - ray.origin, 1, random) * speed;
    if (unlike_speeds) ray.direction = ray.direction * random.uniform(0.5f, 2);
    float& odd = ray.direction[odd_axis];
    if (zeros == 0) odd = random.below(2) ? 0.0f : -0.0f;
    if (zeros == 1 && random.below(2)) odd = random.below(2) ? 0.0f : -0.0f;
    if (zeros == 2) odd = random.uniform() * (random.below(2) ? 1e-39f : 1e-44f);
    if (zeros == 3 && random.below(2)) ray.direction = Vec3{random.below(2) ? 0.0f : -0.0f}, odd = speed;
    if (both_ways && random.below(2)) odd = -odd;
    if (valid(ray)) c.rays.push_back(ray);
  }
  if (c.rays.empty()) return bundle_case(random, reach, pace);

  // Where their ranges end: nowhere, at one place, or each at its own, often where a box is entered.
  float end = kInfinity;
  for (Ray& ray : c.rays) {
    float entry;
    slab(SlabRay(ray), child_box(c.node, static_cast<int>(random.below(BundleCase::kBoxes))), kInfinity, entry);
    if (ends == 2 && &ray == c.rays.data()) end = nudged(entry, 1, random);
    if (ends == 3) end = random.below(4) ? nudged(entry, 1, random) : entry * random.uniform(0.5f, 2);
    ray.tmax = end >= 0 ? end : kInfinity;
  }
  return c;
}

}  // namespace carousel::accel
