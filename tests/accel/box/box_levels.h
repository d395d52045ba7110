#pragma once

#include <bit>
#include <cstdint>

#include <gtest/gtest.h>

#include "accel/box/double_slab.h"
#include "accel/box/slab.h"
#include "accel/certificate/kernel_answers.h"
#include "accel/traverse/kernels.h"
#include "core/config/config.h"
#include "core/types/enum_names.h"
#include "tests/accel/traverse/simd_guard.h"

namespace carousel::accel {

/// The scalar test of a level.
inline BoxAnswer box_answer(BoxLevel level, const Ray& ray, const Aabb& box, float tmax = kInfinity) {
  BoxAnswer a;
  a.hit = level == BoxLevel::kDouble ? slab(DoubleSlabRay(ray), box, tmax, a.entry)
                                     : slab(SlabRay(ray, far_widening(level)), box, tmax, a.entry);
  return a;
}

/// The answer of box_answer(), after making sure that every lane of every SIMD target gives it, too.
inline BoxAnswer box_answer_everywhere(BoxLevel level, const Ray& ray, const Aabb& box, float tmax = kInfinity) {
  const BoxAnswer scalar = box_answer(level, ray, box, tmax);
  Accel accel;
  accel.accuracy.box = level;
  Node& node = accel.nodes.emplace_back();
  node.count = kMaxWidth;
  for (int lane = 0; lane < kMaxWidth; ++lane) {
    for (int axis = 0; axis < 3; ++axis) {
      node.plane[axis][lane] = box.lo[axis];
      node.plane[axis + 3][lane] = box.hi[axis];
    }
  }
  const SimdGuard guard;
  for (const SimdTarget target : usable_simd_targets()) {
    select_simd_target(target);
    RayRecord record;
    record.ray = ray;
    record.hit.t = tmax;
    std::uint8_t mask = 0;
    float nearest[kMaxWidth], entries[kMaxWidth] = {};
    std::fill(nearest, nearest + kMaxWidth, kInfinity);
    IntersectionCounts counts;
    test_strip(accel, {kNoInstance, NodeRef::inner(0)}, ~0u, {&record, nullptr, 1}, {&mask, nearest, entries}, counts);
    EXPECT_EQ(mask, scalar.hit ? 0xff : 0) << enum_name(level) << " on " << enum_name(target);
    if (!scalar.hit) continue;
    for (int lane = 0; lane < kMaxWidth; ++lane) {
      EXPECT_EQ(std::bit_cast<std::uint32_t>(entries[lane]), std::bit_cast<std::uint32_t>(scalar.entry))
          << enum_name(level) << " on " << enum_name(target) << " lane " << lane;
      EXPECT_EQ(nearest[lane], scalar.entry);
    }
  }
  return scalar;
}

}  // namespace carousel::accel
