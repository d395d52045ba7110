#pragma once

#include <vector>

#include "core/config/config.h"
#include "report/run/report.h"
#include "scene/model/scene.h"
#include "shading/effects/effects_plan.h"

namespace carousel::app {

/// Which effects of light the scene calls for, which are computed, why, and what they cost.
std::vector<report::Effect> effects_of(const shading::EffectsPlan& plan);

/// Fills in the effects' part of `out`.
void add_effects(report::Shading& out, const scene::Scene& scene, const Config& config);

}  // namespace carousel::app
