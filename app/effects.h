#pragma once

#include <vector>

#include "core/config.h"
#include "report/report.h"
#include "scene/scene.h"

namespace carousel::app {

/// Which effects of light the scene calls for, and why.
std::vector<report::Effect> effects_of(const scene::Scene& scene, const Config& config);

}  // namespace carousel::app
