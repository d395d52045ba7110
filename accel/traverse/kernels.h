#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "accel/structure/accel.h"
#include "core/config/fields/engine.h"
#include "core/statistics/cull_counts.h"
#include "core/statistics/intersection_counts.h"
#include "core/types/any_hit.h"
#include "core/types/ray.h"

namespace carousel::accel {

/// The rays of one call: records[slots[i]] for i in [0, count), or records[i] when `slots` is null.
struct RayMembers {
  RayRecord* records = nullptr;
  const std::uint32_t* slots = nullptr;
  std::size_t count = 0;
  CullCounts* culls = nullptr;  ///< where cull planes are counted by depth; null: nowhere
  std::vector<AnyHitCall>* any_hit_calls =
      nullptr;  ///< where test_strip() notes any-hit calls, by member; null: nowhere
};

/// The answer of a strip of boxes. Strips of triangles leave it unchanged; their answer is in the rays' hits.
struct StripHits {
  std::uint8_t* masks = nullptr;  ///< one a member: bit l set when child lane l is hit
  float* nearest = nullptr;       ///< one a lane (8): lowered to the nearest entry of any member
  float* entries = nullptr;       ///< null, or 8 a member: the entry of each lane (valid where the mask is set)
};

/// Tests each member against the shapes of `key` that `lanes` selects (boxes below an inner node; of a leaf's
/// triangles, bit i is triangle i in block order). Members that are done are skipped, with an empty mask.
/// Rays are brought to model space when the key is below an instance. SIMD target dispatched once a call.
void test_strip(const Accel& accel, NodeKey key, std::uint32_t lanes, const RayMembers& members, const StripHits& hits,
                IntersectionCounts& counts);

/// Traces each member through everything below `key`, depth-first and nearest first, one ray after another.
void trace_subtree(const Accel& accel, NodeKey key, const RayMembers& members, IntersectionCounts& counts);

/// Traces each member as trace_subtree() does, but with several rays under way, of which one fills the waits of the
/// others. Faster where there are rays enough and the nodes are not all in the first-level cache.
void trace_interleaved(const Accel& accel, NodeKey key, const RayMembers& members, IntersectionCounts& counts);

/// Traces each member as trace_subtree() does, but all of them together, with a list of rays at each node. Faster where
/// lists stay long: below a node of a few hundred triangles a ray. Counts differ a little, as nodes are met in another
/// order. Structures with more than boxes in their nodes, or boxes in double, go as by trace_interleaved(), and so does
/// everything where registers hold fewer than sixteen floats.
void trace_stream(const Accel& accel, NodeKey key, const RayMembers& members, IntersectionCounts& counts);

/// True if trace_stream() uses lists: the registers of the chosen target are wide enough for them.
bool has_lists();

/// Names of the SIMD targets this program was built for and this machine has, best first.
std::vector<std::string> simd_targets();
/// Restricts the kernels to one target; call while nothing traces. Throws ConfigError when the machine lacks it.
void select_simd_target(SimdTarget target);

}  // namespace carousel::accel
