#pragma once

#include <cstdint>
#include <vector>

#include "scene/model/scene.h"
#include "tests/scene/gltf/gltf_builder.h"

namespace carousel::scene {

/// Adds a buffer view compressed by EXT_meshopt_compression; returns its index. `data` are the uncompressed bytes (for
/// a filter: its encoded input), `count` of `stride` bytes. Buffer 0 gets the compressed bytes, then zeros in place of
/// a fallback.
int meshopt_view(GltfBuilder& b, const std::vector<unsigned char>& data, std::size_t count, std::size_t stride,
                 const char* mode, const char* filter = nullptr);

/// A primitive of triangles whose data is a Draco stream of the shape's positions and normals, shown by a node.
/// Returns the mesh.
int draco_mesh(GltfBuilder& b, const Mesh& shape, bool edgebreaker);

/// A lossless WebP.
std::vector<unsigned char> webp(int width, int height, const std::vector<unsigned char>& rgba);

/// One file with every extension of data or materials: Draco by both methods, meshopt in all modes with
/// filters, WebP, all layers of materials, spheres.
GltfBuilder every_extension();

template <class T>
std::vector<unsigned char> bytes_of(const std::vector<T>& values) {
  const auto* first = reinterpret_cast<const unsigned char*>(values.data());
  return {first, first + values.size() * sizeof(T)};
}

}  // namespace carousel::scene
