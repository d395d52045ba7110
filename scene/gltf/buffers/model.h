#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include <tiny_gltf.h>

#include "scene/gltf/buffers/buffers.h"
#include "scene/gltf/document/document.h"
#include "scene/model/scene.h"

namespace carousel::scene {

/// A checked document as tinygltf reads it.
struct GltfModel {
  tinygltf::Model model;
  std::vector<bool> buffer_has_data;  ///< one a buffer; a buffer without data holds one unused byte
  std::uint64_t bytes_read = 0;       ///< bytes of all buffers
};

/// Runs tinygltf over a document that passed check_schema and check_links. Carousel supplies all bytes it gets: files
/// come from `resources`, images are left to read_images, accessors to AccessorTable. Buffers that are a fallback for
/// compressed ones are not read. Throws SceneError.
GltfModel read_model(const GltfDocument& document, const GltfResources& resources);

}  // namespace carousel::scene
