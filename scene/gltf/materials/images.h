#pragma once

#include <cstddef>
#include <vector>

#include "core/system/executor.h"
#include "scene/gltf/buffers/buffers.h"
#include "scene/gltf/buffers/model.h"
#include "scene/model/image_choice.h"
#include "scene/model/scene.h"

namespace carousel::scene {

/// Fills `scene.images`: image i is `file_images[i]` of the file. Only those that `choice` wants are looked for and
/// decoded; the others keep a name and no pixels, whatever is wrong with them. Call when all else of the scene is
/// there. They are decoded on the threads of `executor`, or without one by the caller; the result is the same. Throws
/// SceneError.
void read_images(const GltfDocument& document, const GltfResources& resources, const GltfModel& model,
                 const ImportBudget& budget, const std::vector<std::size_t>& file_images, const ImageChoice& choice,
                 Executor* executor, Scene& scene);

}  // namespace carousel::scene
