#pragma once

#include <vector>

#include "core/config/config.h"
#include "report/run/report.h"
#include "scene/model/scene.h"
#include "shading/effects/effects_plan.h"

namespace carousel::app {

/// Every effect of light with the reason why the scene requires it or not, and its cost.
std::vector<report::Effect> effects_of(const shading::EffectsPlan& plan);

/// Fills in the parts of `out` that concern effects.
void add_effects(report::Shading& out, const scene::Scene& scene, const Config& config);

}  // namespace carousel::app
