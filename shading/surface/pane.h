#pragma once

#include "core/types/vec.h"
#include "scene/model/scene.h"
#include "shading/surface/surface_layers.h"

namespace carousel::shading {

/// True if the material is a thin, smooth wall that light passes straight: what is seen through it is not blurred, so a
/// shadow ray may pass as well. Not with a clearcoat, sheen or grain.
bool is_pane(const scene::Material& material);

/// The share of light that passes a pane straight on, by channel: what its boundary, as rough as it is taken to be,
/// does not reflect. `cosine`: of its direction to the normal, of either sign.
Vec3 passing_share(const InterfacePoint& pane, float cosine);

/// The probability with which a path goes straight on at a pane rather than leaving it by its other lobes: about the
/// share of the light that does so, at most 0.98 where anything is reflected.
float passing_chance(const InterfacePoint& pane, const Vec3& passing, float cosine);

}  // namespace carousel::shading
