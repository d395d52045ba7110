#pragma once

#include <array>
#include <cstddef>
#include <map>

#include "scene/gltf/buffers/buffers.h"
#include "scene/gltf/buffers/model.h"
#include "scene/gltf/document/document.h"

namespace carousel::scene {

/// The extension by its two names: the ratified one adds a version of the attributes' stream, and a filter of colours.
inline constexpr std::array<const char*, 2> kMeshoptExtensions{"EXT_meshopt_compression", "KHR_meshopt_compression"};

/// Unpacks both meshopt extensions, filters included: byteLength bytes for each buffer view with the extension, by
/// index of the view. Throws SceneError for a view with both, for parameters that the extension forbids, for data that
/// ends early or is broken, and, before anything is allocated, for sizes beyond the import's memory.
std::map<std::size_t, Bytes> decode_meshopt_views(const GltfDocument& document, const GltfModel& model,
                                                  const ImportBudget& budget);

}  // namespace carousel::scene
