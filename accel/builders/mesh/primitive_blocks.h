#pragma once

#include <cstdint>

#include "accel/builders/binary/sah_build.h"
#include "accel/builders/mesh/blas_meshes.h"
#include "accel/builders/mesh/mesh_pieces.h"
#include "accel/structure/node.h"
#include "core/system/executor.h"
#include "scene/model/opacity.h"

namespace carousel::accel {

/// The primitives of a mesh with their boxes: triangles, then spheres. With `piece` these alone.
BuildPrimitives primitive_boxes(const BlasMeshes& meshes, Executor& executor, const MeshPiece* piece = nullptr);

/// Puts `count` primitives, at most kBlockTriangles and all of one kind, into a block that has no value yet. Returns
/// true if some of them may be non-opaque.
bool fill_block(const BlasMeshes& meshes, const scene::Opacity& opacity, const std::uint32_t* primitives,
                std::uint32_t count, TriangleBlock& block);

}  // namespace carousel::accel
