#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

#include "core/numeric/trigonometry.h"
#include "scene/builtin/builtin.h"
#include "scene/builtin/hash_random.h"
#include "scene/model/camera_pose.h"

namespace carousel::scene {

Scene make_gaussians(std::int64_t count, std::int64_t seed, int degree) {
  Scene scene;
  scene.name = "gaussians";
  HashRandom random(static_cast<std::uint64_t>(seed), 4);
  const float pi = std::numbers::pi_v<float>;
  // Flat ones on a ball with waves, wide enough that some ten of them overlap at each place, as in clouds that were
  // trained.
  const float width = 0.55f * std::sqrt(4 * pi / static_cast<float>(count));
  scene.gaussians.shapes.reserve(static_cast<std::size_t>(count));
  for (std::int64_t i = 0; i < count; ++i) {
    const float y = random.uniform(-1, 1), angle = random.uniform(0, 2 * pi), ring = std::sqrt(1 - y * y);
    const Vec3 normal{ring * cos_float(angle), y, ring * sin_float(angle)};
    const float wave = sin_float(5 * angle) * sin_float(6 * y);
    const Vec3 side = glm::normalize(glm::cross(std::abs(y) < 0.9f ? Vec3(0, 1, 0) : Vec3(1, 0, 0), normal));
    const float turn = random.uniform(0, 2 * pi);
    const Vec3 first = cos_float(turn) * side + sin_float(turn) * glm::cross(normal, side);
    Gaussian gaussian;
    gaussian.mean = normal * (1 + 0.12f * wave + random.uniform(-0.02f, 0.02f));
    const Vec3 deviations{random.uniform(0.5f, 1.5f), random.uniform(0.5f, 1.5f), random.uniform(0.05f, 0.3f)};
    gaussian.spread = Mat3(first * (width * deviations.x), glm::cross(normal, first) * (width * deviations.y),
                           normal * (width * deviations.z));
    gaussian.opacity = random.uniform(0.2f, 0.95f);
    const float shade = random.uniform(0.7f, 1.0f);
    gaussian.color = shade * Vec3(0.5f + 0.4f * wave, 0.35f + 0.25f * y, 0.5f - 0.4f * wave);
    scene.gaussians.shapes.push_back(gaussian);
  }
  // Weaker by degree, as in clouds that were trained.
  HashRandom harmonics(static_cast<std::uint64_t>(seed), 9);
  scene.gaussians.degree = degree;
  scene.gaussians.harmonics.reserve(static_cast<std::size_t>(count) * higher_harmonics(degree));
  for (std::int64_t i = 0; i < count; ++i)
    for (int of = 1; of <= degree; ++of)
      for (int order = -of; order <= of; ++order) {
        const float most = 0.3f / static_cast<float>(of);
        scene.gaussians.harmonics.push_back(
            Vec3{harmonics.uniform(-most, most), harmonics.uniform(-most, most), harmonics.uniform(-most, most)});
      }
  scene.sky.radiance = {0.05f, 0.07f, 0.1f};
  scene.cameras.push_back(look_at({1.6f, 1.1f, 2.8f}, {0, 0, 0}, 0.75f));
  scene.cameras.back().name = "outside";
  return scene;
}

}  // namespace carousel::scene
