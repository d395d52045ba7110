#include <algorithm>
#include <cmath>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "core/numeric/trigonometry.h"
#include "scene/builtin/builtin.h"
#include "scene/builtin/hash_random.h"
#include "scene/model/camera_pose.h"

namespace carousel::scene {

namespace {

constexpr float kSize = 20;  // edge of the square, scene units
constexpr float kHeight = 4.0f;

/// Gradient noise on the integer lattice, about -1 to 1: Perlin, "Improving Noise", SIGGRAPH 2002, with a
/// hash in place of the permutation table.
class Noise {
 public:
  explicit Noise(std::int64_t seed) : seed_(static_cast<std::uint64_t>(seed)) {}

  float operator()(float x, float z) const {
    const float fx = std::floor(x), fz = std::floor(z);
    const auto ix = static_cast<std::int32_t>(fx), iz = static_cast<std::int32_t>(fz);
    const float u = x - fx, v = z - fz;
    const float a = fade(u), b = fade(v);
    const float near = glm::mix(gradient(ix, iz, u, v), gradient(ix + 1, iz, u - 1, v), a);
    const float far = glm::mix(gradient(ix, iz + 1, u, v - 1), gradient(ix + 1, iz + 1, u - 1, v - 1), a);
    return 1.4f * glm::mix(near, far, b);
  }

 private:
  static float fade(float t) { return t * t * t * (t * (6 * t - 15) + 10); }

  float gradient(std::int32_t x, std::int32_t z, float u, float v) const {
    const std::uint64_t key =
        static_cast<std::uint64_t>(static_cast<std::uint32_t>(x)) << 32 | static_cast<std::uint32_t>(z);
    HashRandom random(seed_, key);
    const float gx = random.uniform(-1, 1), gz = random.uniform(-1, 1);
    const float length = std::max(std::sqrt(gx * gx + gz * gz), 1e-3f);
    return (gx * u + gz * v) / length;
  }

  std::uint64_t seed_;
};

/// Ridged fBm: sharp crests and smooth valleys (Musgrave, in "Texturing and Modeling", 3rd ed., chapter 16).
/// Octaves too fine for a grid of that `step` are left out: they would only be aliased.
float height_at(const Noise& noise, float x, float z, float step) {
  float sum = 0, amplitude = 0.5f, weight = 1;
  float frequency = 0.11f, px = frequency * x, pz = frequency * z;
  for (int octave = 0; octave < 10 && (octave == 0 || frequency * step < 0.25f); ++octave) {
    float ridge = 1 - std::abs(noise(px, pz));
    ridge *= ridge * weight;
    weight = std::clamp(1.6f * ridge, 0.0f, 1.0f);
    sum += amplitude * ridge;
    amplitude *= 0.5f;
    frequency *= 2.03f;
    px = 2.03f * px + 17.3f;
    pz = 2.03f * pz - 9.1f;
  }
  return kHeight * (sum - 0.35f);
}

Vec4 color_of(float height, float slope, float grain) {
  const Vec3 grass{0.10f, 0.17f, 0.04f}, meadow{0.22f, 0.24f, 0.08f}, rock{0.23f, 0.20f, 0.18f},
      snow{0.85f, 0.88f, 0.93f};
  const float h = height / kHeight + 0.05f * grain;
  Vec3 color = glm::mix(grass, meadow, glm::smoothstep(0.0f, 0.3f, h));
  color = glm::mix(color, rock, std::max(glm::smoothstep(0.28f, 0.42f, h), glm::smoothstep(0.2f, 0.42f, slope)));
  color = glm::mix(color, snow, glm::smoothstep(0.42f, 0.52f, h) * (1 - glm::smoothstep(0.3f, 0.5f, slope)));
  return Vec4(color * (1 + 0.15f * grain), 1);
}

/// How much a wave of about 10 units' length, which runs across the ground, has raised a point since 0.
float wave(float x, float z, float seconds) {
  if (seconds == 0) return 0;
  const float phase = 0.6f * x + 0.35f * z;
  return 0.5f * (sin_float(phase - 2 * seconds) - sin_float(phase));
}

}  // namespace

Scene make_terrain(std::int64_t triangles, std::int64_t seed, float seconds) {
  Scene scene;
  scene.name = "terrain";
  Material material;
  material.name = "ground";
  material.metallic = 0;
  material.roughness = 1;
  scene.materials.push_back(material);

  const auto cells = std::max<std::uint32_t>(
      1, static_cast<std::uint32_t>(std::lround(std::sqrt(0.5 * static_cast<double>(triangles)))));
  const std::uint32_t row = cells + 1;
  const float step = kSize / static_cast<float>(cells);
  const Noise noise(seed);
  const auto place = [&](std::uint32_t i) { return -0.5f * kSize + step * static_cast<float>(i); };

  Mesh mesh;
  mesh.name = "terrain";
  mesh.positions.reserve(std::size_t{row} * row);
  std::vector<float> still;  // heights without waves, which choose the colours
  still.reserve(std::size_t{row} * row);
  for (std::uint32_t j = 0; j < row; ++j) {
    for (std::uint32_t i = 0; i < row; ++i) {
      const float height = height_at(noise, place(i), place(j), step);
      mesh.positions.push_back({place(i), height + wave(place(i), place(j), seconds), place(j)});
      still.push_back(height);
    }
  }
  const auto height = [&](std::uint32_t i, std::uint32_t j) { return mesh.positions[std::size_t{j} * row + i].y; };
  for (std::uint32_t j = 0; j < row; ++j) {
    for (std::uint32_t i = 0; i < row; ++i) {
      const std::uint32_t i0 = i > 0 ? i - 1 : 0, i1 = std::min(i + 1, cells);
      const std::uint32_t j0 = j > 0 ? j - 1 : 0, j1 = std::min(j + 1, cells);
      const float dx = (height(i1, j) - height(i0, j)) / (step * static_cast<float>(i1 - i0));
      const float dz = (height(i, j1) - height(i, j0)) / (step * static_cast<float>(j1 - j0));
      const Vec3 normal = glm::normalize(Vec3{-dx, 1, -dz});
      mesh.normals.push_back(normal);
      mesh.colors.push_back(
          color_of(still[std::size_t{j} * row + i], 1 - normal.y, noise(3.1f * place(i) + 40, 3.1f * place(j))));
    }
  }
  for (std::uint32_t j = 0; j < cells; ++j) {
    for (std::uint32_t i = 0; i < cells; ++i) {
      const std::uint32_t a = j * row + i, b = a + 1, c = a + row, d = c + 1;
      mesh.indices.insert(mesh.indices.end(), {a, c, b, b, c, d});
    }
  }
  mesh.triangle_materials.assign(mesh.triangle_count(), MaterialId(0));

  const float ground = height_at(noise, 0, 9.0f, 1);
  scene.meshes.push_back(std::move(mesh));
  scene.instances = {{MeshId(0), {}}};

  PunctualLight sun;
  sun.kind = PunctualLight::Kind::kDirectional;
  sun.intensity = {4.6f, 3.9f, 2.9f};
  sun.direction = glm::normalize(Vec3{0.8f, -0.5f, -0.3f});
  scene.lights.push_back(sun);
  scene.sky.radiance = {0.36f, 0.52f, 0.80f};

  scene.cameras.push_back(look_at({1.5f, std::max(ground, 0.0f) + 4.0f, 12.0f}, {0, 0.2f, 0}, 0.75f));
  scene.cameras.back().name = "valley";
  scene.cameras.push_back(look_at({0, 28, 0.01f}, {0, 0, 0}, 0.75f, {0, 0, -1}));
  scene.cameras.back().name = "above";
  return scene;
}

}  // namespace carousel::scene
