#pragma once

#include "shading/effects/effect_rule.h"

namespace carousel::shading {

// Rays beyond the camera's are called for by the lights and surfaces of the whole scene.

Need shadow_rays(const PlanInput& in);
Need bounce_rays(const PlanInput& in);
Need transparent_shadows(const PlanInput& in);

}  // namespace carousel::shading
