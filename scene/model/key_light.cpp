#include "scene/model/key_light.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <vector>

#include <glm/geometric.hpp>

#include "core/numeric/exponential.h"

namespace carousel::scene {

namespace {

/// The mean of the texels' luminance, in linear light; that of an image that was not decoded is 0. Large images are
/// sampled.
double mean_luminance(const Image& image) {
  constexpr std::size_t kMostTexels = 1 << 18;
  const std::size_t texels = image.rgba.size() / 4, stride = texels / kMostTexels + 1;
  const auto linear = [](std::uint8_t value) { return pow_precise(value / 255.0, 2.2); };  // sRGB, near enough
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < texels; i += stride, ++count) {
    const std::uint8_t* p = &image.rgba[4 * i];
    sum += 0.2126 * linear(p[0]) + 0.7152 * linear(p[1]) + 0.0722 * linear(p[2]);
  }
  return count == 0 ? 0 : sum / static_cast<double>(count);
}

/// True for each material that could light a scene: one with an emissive factor, unless the texture below it is mostly
/// black, as where lamps of an object are painted.
std::vector<bool> lighting_materials(const Scene& scene) {
  constexpr double kMostlyBlack = 0.1;
  std::vector<bool> out(scene.materials.size());
  std::map<ImageId, bool> lit;
  for (std::size_t m = 0; m < out.size(); ++m) {
    const Material& material = scene.materials[m];
    if (material.emissive == Vec3(0.0f)) continue;
    out[m] = true;
    if (!material.emissive_texture) continue;
    const ImageId image = scene.textures[material.emissive_texture->texture.value].image;
    const auto [entry, fresh] = lit.try_emplace(image, false);
    if (fresh) entry->second = mean_luminance(scene.images[image.value]) >= kMostlyBlack;
    out[m] = entry->second;
  }
  return out;
}

}  // namespace

bool has_light(const Scene& scene) {
  if (!scene.lights.empty() || !scene.gaussians.empty()) return true;
  const std::vector<bool> lighting = lighting_materials(scene);
  return std::any_of(scene.instances.begin(), scene.instances.end(), [&](const Instance& instance) {
    const std::vector<MaterialId>& used = scene.meshes[instance.mesh.value].triangle_materials;
    return std::any_of(used.begin(), used.end(), [&](MaterialId m) { return lighting[m.value]; });
  });
}

PunctualLight key_light(const Camera& camera) {
  PunctualLight light;
  light.kind = PunctualLight::Kind::kDirectional;
  light.intensity = Vec3(2.2f, 2.1f, 1.9f);
  light.direction = -glm::normalize(camera.back + 1.2f * camera.up - 0.7f * camera.right);
  return light;
}

}  // namespace carousel::scene
