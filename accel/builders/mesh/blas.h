#pragma once

#include <vector>

#include "accel/builders/mesh/blas_meshes.h"
#include "accel/builders/mesh/mesh_pieces.h"
#include "accel/builders/mesh/wide_collapse.h"
#include "accel/structure/node.h"
#include "core/config/fields/bvh.h"
#include "core/system/executor.h"
#include "core/types/aabb.h"
#include "scene/model/opacity.h"
#include "scene/model/scene.h"

namespace carousel::accel {

/// Bottom-level structure of one mesh or of several, with references into its own arrays.
struct Blas {
  NodeArray nodes;
  BlockArray blocks;
  WideTree tree;  ///< meaningless when the mesh is empty
  Aabb box;
  bool has_non_opaque = false;  ///< some primitives have kNonOpaqueBit
};

/// Primitives that may be non-opaque get kNonOpaqueBit. With `piece` over these primitives alone.
Blas build_blas(const BlasMeshes& meshes, const scene::Opacity& opacity, const BvhConfig& config, Executor& executor,
                const MeshPiece* piece = nullptr);

}  // namespace carousel::accel
