#pragma once

#include <vector>

#include "core/config/config.h"
#include "report/run/report.h"
#include "scene/model/scene.h"
#include "shading/effects/effects_plan.h"

namespace carousel::app {

/// The effects that the scene calls for, with the reasons, the computed ones and their costs.
std::vector<report::Effect> effects_of(const shading::EffectsPlan& plan);

/// Fills in the effects in `out`.
void add_effects(report::Shading& out, const scene::Scene& scene, const Config& config);

}  // namespace carousel::app
