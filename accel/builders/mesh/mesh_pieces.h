#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "scene/model/scene.h"

namespace carousel::accel {

/// Primitives of a mesh that get a structure of their own, in ascending order.
using MeshPiece = std::vector<std::uint32_t>;

/// Divides a mesh into pieces of at most `most` primitives: again and again in two halves, across the longest side of
/// what their middles span. The pieces depend on the mesh alone. Preconditions: most > 0.
std::vector<MeshPiece> divide_mesh(const scene::Mesh& mesh, std::size_t most);

}  // namespace carousel::accel
