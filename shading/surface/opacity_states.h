#pragma once

#include <cstdint>

#include "scene/model/opacity_micromaps.h"
#include "scene/model/scene.h"

namespace carousel::shading {

/// Makes the opacity micromaps of a scene from its alpha textures, factors and vertex colours: `level` from 0 to 6,
/// `four_states` as bvh.micromaps.states. A state is known only where the any-hit call (AlphaTest) has that answer for
/// every hit that is looked up there, rounding included, so that micromaps change no picture. Spheres have none.
/// Precondition: fewer than 2^32 - 4 triangles have maps.
scene::OpacityMicromaps make_micromaps(const scene::Scene& scene, int level, bool four_states);

}  // namespace carousel::shading
