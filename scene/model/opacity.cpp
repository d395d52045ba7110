#include "scene/model/opacity.h"

#include <algorithm>

namespace carousel::scene {

namespace {

float least_alpha(const Image& image) {
  std::uint8_t least = 255;
  for (std::size_t i = 3; i < image.rgba.size() && least > 0; i += 4) least = std::min(least, image.rgba[i]);
  return static_cast<float>(least) * (1.0f / 255.0f);
}

/// Below this a ray may pass.
float solid_from(const Material& material) {
  return (material.alpha_mode == AlphaMode::kMask ? material.alpha_cutoff : 1.0f) - kAlphaTolerance;
}

}  // namespace

Opacity::Opacity(const Scene& scene) : scene_(scene), least_(scene.materials.size(), 1.0f) {
  std::vector<float> images(scene.images.size(), -1.0f);  // not looked at yet
  bool colors = false;
  for (const Mesh& mesh : scene.meshes) colors = colors || !mesh.colors.empty();
  for (std::size_t m = 0; m < scene.materials.size(); ++m) {
    const Material& material = scene.materials[m];
    if (material.alpha_mode == AlphaMode::kOpaque) continue;
    least_[m] = material.base_color.a;
    if (material.base_color_texture) {
      const std::uint32_t image = scene.textures[material.base_color_texture->texture.value].image.value;
      if (images[image] < 0.0f) images[image] = least_alpha(scene.images[image]);
      least_[m] *= images[image];
    }
    any_ = any_ || colors || least_[m] < solid_from(material);
  }
}

bool Opacity::may_be_non_opaque(const Mesh& mesh, std::uint32_t triangle) const {
  const std::uint32_t id = mesh.triangle_materials[triangle].value;
  const Material& material = scene_.materials[id];
  if (material.alpha_mode == AlphaMode::kOpaque) return false;
  float least = least_[id];
  if (!mesh.colors.empty()) {
    const std::uint32_t* corner = mesh.indices.data() + 3 * std::size_t{triangle};
    least *= std::min({mesh.colors[corner[0]].a, mesh.colors[corner[1]].a, mesh.colors[corner[2]].a});
  }
  return !(least >= solid_from(material));
}

bool Opacity::may_be_non_opaque(const Sphere& sphere) const {
  const Material& material = scene_.materials[sphere.material.value];
  return material.alpha_mode != AlphaMode::kOpaque && !(least_[sphere.material.value] >= solid_from(material));
}

}  // namespace carousel::scene
