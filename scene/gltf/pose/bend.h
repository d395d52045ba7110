#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <tiny_gltf.h>

#include "core/types/vec.h"
#include "scene/gltf/buffers/accessor.h"
#include "scene/gltf/document/document.h"

namespace carousel::scene {

/// How a node bends the vertices of its mesh.
struct Bend {
  std::vector<double> weights;                 ///< one a morph target; empty: all are 0
  const std::vector<DMat4>* joints = nullptr;  ///< world from bound mesh, a joint; null: there is no skin
  std::size_t skin = 0;                        ///< index of that skin
};

/// Moves positions and normals of a primitive by its morph targets, then by its joints, in double, and rounds them
/// once. The weights of a vertex are divided by their sum; a vertex whose weights are all 0 goes with the first of its
/// joints. `normals` is empty or has as many elements as `positions`; they need not be of unit length afterwards.
/// Tangents are none of the arguments: shading takes them from positions and texture coordinates. Throws SceneError at
/// the attribute that is wrong.
void bend_vertices(const GltfDocument& document, const AccessorTable& accessors, const ImportBudget& budget,
                   const tinygltf::Primitive& primitive, const std::string& path, const Bend& bend,
                   std::vector<Vec3>& positions, std::vector<Vec3>& normals);

}  // namespace carousel::scene
