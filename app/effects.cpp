#include "app/effects.h"

#include <algorithm>

#include <fmt/format.h>

#include "shading/surface.h"

namespace carousel::app {

namespace {

template <class Predicate>
std::size_t count(const scene::Scene& scene, const Predicate& predicate) {
  return static_cast<std::size_t>(std::count_if(scene.materials.begin(), scene.materials.end(), predicate));
}

report::Effect by_count(const char* name, std::size_t count, const char* what) {
  return {name, count > 0, fmt::format("{} {}", count, what)};
}

}  // namespace

std::vector<report::Effect> effects_of(const scene::Scene& scene, const Config& config) {
  const std::size_t glowing = count(scene, shading::is_emissive);
  const Vec3& sky = scene.sky.radiance;
  const bool lights = !scene.lights.empty() || glowing > 0, bright_sky = sky.x > 0 || sky.y > 0 || sky.z > 0;
  const bool bounces = config.image.max_depth > 1;
  std::vector<report::Effect> effects;
  effects.push_back(
      {"shadow", lights, fmt::format("{} lights, {} glowing materials", scene.lights.size(), glowing)});
  effects.push_back({"bounce", bounces, fmt::format("image.max_depth {}", config.image.max_depth)});
  effects.push_back({"sky", bright_sky, bright_sky ? "the sky has radiance" : "the sky is black"});
  effects.push_back(by_count("emission", glowing, "glowing materials"));
  effects.push_back(
      by_count("metallic", count(scene, [](const auto& m) { return m.metallic > 0; }), "metallic materials"));
  effects.push_back(by_count("texture", scene.textures.size(), "textures"));
  effects.push_back(by_count("normal_map",
                             count(scene, [](const auto& m) { return m.normal_texture.has_value(); }),
                             "materials with a normal map"));
  const std::size_t holes =
      count(scene, [](const auto& m) { return m.alpha_mode != scene::AlphaMode::kOpaque; });
  effects.push_back({"alpha", false, fmt::format("not computed; {} materials are taken for opaque", holes)});
  return effects;
}

}  // namespace carousel::app
