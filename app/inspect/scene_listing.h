#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include "report/run/report.h"
#include "scene/model/scene.h"

namespace carousel::app {

/// What `carousel inspect` says of a scene: contents, motion, bounds, and the effects of light in `shading`.
nlohmann::ordered_json listing_json(const scene::Scene& scene, const report::Shading& shading);
std::string listing_text(const scene::Scene& scene, const report::Shading& shading);

}  // namespace carousel::app
