#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

#include "core/numeric/trigonometry.h"
#include "scene/builtin/builtin.h"
#include "scene/builtin/hash_random.h"
#include "scene/builtin/mesh_shapes.h"
#include "scene/builtin/random_rotation.h"
#include "scene/model/camera_pose.h"

namespace carousel::scene {

namespace {

constexpr std::uint32_t kTexels = 64;  // edge of the leaf's picture
constexpr int kTrees = 9;
constexpr float kCrownRadius = 1.6f, kCrownHeight = 3.2f;

/// Half the width of the leaf at a height from its stem, 0, to its tip, 1, in parts of the picture's width.
float half_width(float height) {
  if (height < 0.12f) return 0.025f;  // the stem
  const float along = (height - 0.12f) / 0.88f;
  return 0.42f * std::sqrt(along) * (1 - along) * 2.6f * (1 - 0.10f * std::abs(sin_float(22 * along)));
}

/// A serrated leaf, opaque but for a border of half a texel, in which its alpha falls to 0.
Image leaf_picture() {
  Image image{"leaf", kTexels, kTexels, std::vector<std::uint8_t>(4 * std::size_t{kTexels} * kTexels)};
  for (std::uint32_t y = 0; y < kTexels; ++y)
    for (std::uint32_t x = 0; x < kTexels; ++x) {
      const float across = (static_cast<float>(x) + 0.5f) / kTexels - 0.5f;
      const float height = 1 - (static_cast<float>(y) + 0.5f) / kTexels;
      const float inside = (half_width(height) - std::abs(across)) * kTexels;
      std::uint8_t* texel = image.rgba.data() + 4 * (std::size_t{y} * kTexels + x);
      const bool vein = std::abs(across) < 0.02f;
      texel[0] = vein ? 150 : 96;
      texel[1] = vein ? 172 : 140;
      texel[2] = vein ? 92 : 52;
      texel[3] = static_cast<std::uint8_t>(std::lround(255 * std::clamp(inside + 0.5f, 0.0f, 1.0f)));
    }
  return image;
}

MaterialId add_leaf(Scene& scene) {
  scene.images.push_back(leaf_picture());
  scene.textures.push_back({ImageId(0), Wrap::kClamp, Wrap::kClamp, true});
  const MaterialId id = add_material(scene, "leaf", {0.9f, 1, 0.8f}, 0, 0.7f);
  Material& leaf = scene.materials[id.value];
  leaf.base_color_texture = TextureUse{TextureId(0)};
  leaf.alpha_mode = AlphaMode::kMask;
  leaf.double_sided = true;
  return id;
}

/// A square with the whole picture on it.
void add_card(Mesh& mesh, const Vec3& middle, const Vec3& right, const Vec3& up, MaterialId material) {
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.insert(mesh.positions.end(),
                        {middle - right - up, middle + right - up, middle + right + up, middle - right + up});
  mesh.uv0.insert(mesh.uv0.end(), {{0, 1}, {1, 1}, {1, 0}, {0, 0}});
  mesh.indices.insert(mesh.indices.end(), {first, first + 1, first + 2, first, first + 2, first + 3});
  mesh.triangle_materials.insert(mesh.triangle_materials.end(), 2, material);
}

Mesh crown(std::int64_t triangles, std::int64_t seed, MaterialId leaf) {
  Mesh mesh;
  mesh.name = "crown";
  const auto cards = std::max<std::int64_t>(1, (triangles + 1) / 2);
  // Crowns of many leaves have smaller ones, so that rays meet about as many of them.
  const float size = std::min(0.6f, 3.2f / std::sqrt(static_cast<float>(cards)));
  HashRandom random(static_cast<std::uint64_t>(seed), 7);
  for (std::int64_t k = 0; k < cards; ++k) {
    const Mat3 place = random_rotation(random), turn = random_rotation(random);
    const float radius = kCrownRadius * std::sqrt(random.uniform(0.2f, 1.0f)), own = size * random.uniform(0.7f, 1.0f);
    add_card(mesh, Vec3{0, kCrownHeight, 0} + place[0] * radius, turn[0] * own, turn[1] * own, leaf);
  }
  return mesh;
}

}  // namespace

Scene make_foliage(std::int64_t triangles, std::int64_t seed) {
  Scene scene;
  scene.name = "foliage";
  const MaterialId leaf = add_leaf(scene);
  const MaterialId bark = add_material(scene, "bark", {0.20f, 0.13f, 0.08f}, 0, 0.9f);
  const MaterialId meadow = add_material(scene, "meadow", {0.16f, 0.24f, 0.07f}, 0, 1);
  scene.meshes.push_back(crown(triangles, seed, leaf));
  Mesh trunk;
  trunk.name = "trunk";
  add_cone(trunk, 0.16f, kCrownHeight, 12, bark);
  scene.meshes.push_back(std::move(trunk));
  Mesh ground;
  ground.name = "ground";
  add_quad(ground, {-60, 0, 60}, {60, 0, 60}, {60, 0, -60}, {-60, 0, -60}, meadow);
  scene.meshes.push_back(std::move(ground));

  HashRandom random(static_cast<std::uint64_t>(seed), 8);
  for (int tree = 0; tree < kTrees; ++tree) {
    const float turn = random.uniform(0, 2 * std::numbers::pi_v<float>), scale = random.uniform(0.8f, 1.2f);
    Affine place;
    place.linear = Mat3(scale * cos_float(turn), 0, -scale * sin_float(turn), 0, scale, 0, scale * sin_float(turn), 0,
                        scale * cos_float(turn));
    place.translation = {3.4f * static_cast<float>(tree % 3 - 1) + random.uniform(-0.5f, 0.5f), 0,
                         -3.4f * static_cast<float>(tree / 3) + random.uniform(-0.5f, 0.5f)};
    scene.instances.push_back({MeshId(0), place});
    scene.instances.push_back({MeshId(1), place});
  }
  scene.instances.push_back({MeshId(2), {}});

  PunctualLight sun;
  sun.kind = PunctualLight::Kind::kDirectional;
  sun.intensity = {4.2f, 3.8f, 3.0f};
  sun.direction = glm::normalize(Vec3{0.6f, -0.8f, -0.4f});
  scene.lights.push_back(sun);
  scene.sky.radiance = {0.42f, 0.56f, 0.78f};

  scene.cameras.push_back(look_at({0.6f, 2.4f, 7.5f}, {0, 2.6f, -2}, 0.8f));
  scene.cameras.back().name = "meadow";
  scene.cameras.push_back(look_at({0.2f, 3.1f, 3.2f}, {0, 3.2f, 0}, 0.8f));
  scene.cameras.back().name = "crown";
  return scene;
}

}  // namespace carousel::scene
