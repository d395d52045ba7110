#pragma once

#include "accel/structure/accel.h"
#include "core/statistics/cull_counts.h"

namespace carousel::accel {

/// Counts a child whose box was hit and which was culled.
inline void count_culled(const Accel& accel, NodeRef child, CullLevel& level) {
  switch (child.kind()) {
    case NodeRef::Kind::kInner:
      ++level.nodes;
      break;
    case NodeRef::Kind::kLeaf:
      ++level.leaves;
      level.triangles += child.triangles();
      break;
    case NodeRef::Kind::kProcedural:
      ++level.leaves;
      level.procedural += child.triangles();
      break;
    case NodeRef::Kind::kInstance:
      ++level.instances;
      level.transforms += !accel.instances[child.instance_index()].transform.identity;
      break;
  }
}

}  // namespace carousel::accel
