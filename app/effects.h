#pragma once

#include <cstdint>
#include <vector>

#include "core/config.h"
#include "report/report.h"
#include "scene/scene.h"
#include "shading/effects_plan.h"

namespace carousel::app {

/// Which effects of light the scene calls for, which are computed, why, and what they cost.
std::vector<report::Effect> effects_of(const shading::EffectsPlan& plan);

/// Fills in the effects' part of `out`. `unread_image_bytes` as drop_unread_images() says.
void add_effects(report::Shading& out, const scene::Scene& scene, const Config& config, std::uint64_t unread_image_bytes);

}  // namespace carousel::app
