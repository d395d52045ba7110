#pragma once

#include "scene/scene.h"

namespace carousel::scene {

/// Whether rays may pass where they meet the material, so that it has to be asked (core/any_hit.h).
inline bool may_pass(const Material& material) { return material.alpha_mode != AlphaMode::kOpaque; }

}  // namespace carousel::scene
