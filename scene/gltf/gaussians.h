#pragma once

#include <tiny_gltf.h>

#include "scene/gltf/buffers/accessor.h"
#include "scene/gltf/document/document.h"
#include "scene/model/scene.h"

namespace carousel::scene {

/// True for a primitive with KHR_gaussian_splatting.
bool has_gaussians(const tinygltf::Primitive& primitive);

/// Adds the Gaussians of all instances' primitives with KHR_gaussian_splatting (kernel ellipse), in the order of the
/// instances, moved into the world by their transforms. Their scales are linear, as in the extension since February
/// 2026 (glTF issue 2563); earlier drafts had logarithms. Harmonics are given in the space of the node.
/// Instances name meshes of the file. Throws SceneError for attributes that are missing or out of range, degrees of
/// harmonics that are not whole, primitives that are no points, and two colour spaces in one file.
void read_gaussians(const GltfDocument& document, const tinygltf::Model& model, const AccessorTable& accessors,
                    const ImportBudget& budget, Scene& scene);

}  // namespace carousel::scene
