#pragma once

#include <string>

#include "accel/builders/file/tree_file.h"
#include "accel/builders/mesh/blas.h"

namespace carousel::accel {

/// The longest way down a tree of a file, in nodes: as long as a tree that is built here may be, since the stacks of
/// depth-first tracers have that much room.
inline constexpr int kFileTreeDepth = 72;

/// The structure of a mesh whose tree comes from a file (US 12394134 (43) lets the structure be built elsewhere). Nodes
/// keep the order of the file, blocks have that of a depth-first walk.
/// Throws a SceneError with the line of the first fault: a tree over another number of primitives; a node that more or
/// fewer than one other names, or one that does not come after that; too many children or primitives of a leaf; a
/// primitive that is in no leaf or in two; a box that does not hold what is below it. So what is returned gives the
/// same hits as a structure that is built here.
Blas blas_of_file(const FileTree& tree, const std::string& file, const BlasMeshes& meshes,
                  const scene::Opacity& opacity, const BvhConfig& config, Executor& executor);

}  // namespace carousel::accel
