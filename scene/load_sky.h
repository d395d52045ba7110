#pragma once

#include <filesystem>

#include "core/config/fields/scene.h"
#include "scene/model/sky_map.h"
#include "scene/model/warnings.h"

namespace carousel::scene {

/// Reads the environment map `file`, Radiance or OpenEXR, told apart by content, with rotation and strength of the
/// configuration. Texels that are no light are replaced, and a warning counts them: NaN and negative values by 0,
/// values above SkyMap::kMostRadiance, infinite ones among them, by the largest other of the map. Throws SceneError,
/// which names the file, for what it cannot read.
SkyMap load_sky_map(const std::filesystem::path& file, const SkyConfig& config, const WarningSink& warn = {});

}  // namespace carousel::scene
