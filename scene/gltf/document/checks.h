#pragma once

#include <cstddef>

#include "scene/gltf/document/document.h"
#include "scene/model/warnings.h"

namespace carousel::scene {

/// The number of morph targets of all meshes, of the JSON as it was parsed.
std::size_t count_morph_targets(const Json& json);

/// Refuses a file that requires an extension Carousel does not read; warns once of the optional ones it
/// ignores, and of skins, morph targets and animations where document.posing leaves them in their base pose. For the
/// JSON as it was parsed, before check_schema.
void check_extensions(const GltfDocument& document, const WarningSink& warn);

/// Checks rules that the schema cannot express, on the JSON after check_schema: buffer views lie inside their buffers,
/// an image has one source, indices are stored somewhere, cameras and spot lights have their details, and the nodes
/// form trees. Throws SceneError. Faults that change nothing that is shown are warnings: images and cameras that are
/// not used, channels of animations, and roots that a scene names twice or that are below another of its roots; these
/// are removed from the list.
void check_links(GltfDocument& document, const WarningSink& warn);

}  // namespace carousel::scene
