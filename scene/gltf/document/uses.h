#pragma once

#include <vector>

#include "scene/gltf/document/document.h"

namespace carousel::scene {

/// The entries of a file's arrays that decide what is seen: all others may have faults without harm.
struct Uses {
  std::vector<bool> textures, images, samplers;  ///< used by materials, for other than occlusion, which is not read
  std::vector<bool> cameras;                     ///< used by nodes
  std::vector<bool> accessors;                   ///< used by meshes and instances; by what is posed, if it is
  std::vector<bool> skins, animations;           ///< used by the pose
};

/// For the JSON after check_schema.
Uses uses_of(const Json& json, const Posing& posing = {});

/// True if a texture of the material reads TEXCOORD_<set>; occlusion apart. For the JSON after check_schema.
bool reads_tex_coords(const Json& material, int set);

}  // namespace carousel::scene
