#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "accel/certificate/bipyramid.h"
#include "accel/certificate/case_values.h"
#include "accel/certificate/kernel_answers.h"
#include "accel/certificate/placement_cases.h"
#include "accel/certificate/properties.h"
#include "accel/certificate/quad_inverse.h"
#include "accel/certificate/triangle_oracle.h"
#include "accel/exact/exact_crossing.h"
#include "accel/traverse/ray_check.h"
#include "core/numeric/condition.h"

namespace carousel::accel {

namespace {

constexpr float kFarthest = std::numeric_limits<float>::max();

CaseValues make_closed_mesh(CaseRandom& random) {
  const std::size_t sides = kLeastRing + random.below(kMostRing - kLeastRing + 1);
  // Flattened and moved away, but never so far that the corners' rounding could turn it inside out.
  const int flat = static_cast<int>(random.below(12)),
            away = random.below(2) ? static_cast<int>(random.below(static_cast<std::uint32_t>(16 - flat))) : -100;
  DVec3 scale(1);
  if (random.below(2)) scale[static_cast<int>(random.below(3))] = std::ldexp(1.0, -flat);
  const double size = std::ldexp(1.0, static_cast<int>(random.below(200)) - 100);
  const DMat3 turn = random.below(3) ? rotation(random_direction(random), 360.0 * random.uniform()) : DMat3(1.0);
  const DVec3 centre = std::ldexp(1.0, away) * random_direction(random);
  const auto world = [&](const DVec3& p) { return Vec3(size * (centre + turn * (scale * p))); };

  const std::vector<Vec3> corners = bipyramid_corners(sides, random, world);
  const EdgePoint edge = edge_point(corners, random);
  Ray ray;
  ray.origin = world(random.below(5) ? DVec3(random.in_box(Vec3{-0.12f}, Vec3{0.12f})) : DVec3(0));
  ray.direction = nudged(edge.at - ray.origin, edge.how == 3 ? 1 : 0, random);
  CaseWriter out;
  out.add(ray);
  for (const Vec3& corner : corners) out.add(corner);
  return out.take();
}

void judge_closed_mesh(const CaseValues& values, std::span<const AccuracyConfig> levels, std::span<Judgement> out,
                       CaseStory* story) {
  CaseReader read(values);
  const Ray ray = read.ray();
  const bool finite = read.rest_is_finite();
  const Vec3 apex = read.vector(), nadir = read.vector();
  std::vector<Vec3> ring;
  while (read.more()) ring.push_back(read.vector());
  if (!valid(ray) || ray.tmin != 0 || ray.tmax != kInfinity || !finite) return;
  const std::vector<Corners> triangles = bipyramid(apex, nadir, ring);
  // Something ahead and something behind: the origin is inside.
  std::size_t ahead = 0, behind = 0;
  for (const Corners& corners : triangles) {
    const TriangleOracle oracle(ray, corners);
    if (!oracle.hit()) continue;
    ahead += oracle.compare_t(0) > 0 && oracle.compare_t(kFarthest) <= 0;
    behind += oracle.compare_t(0) < 0;
  }
  OneLeaf leaf(triangles);
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const Hit hit = leaf.hit(ray, levels[i]);
    out[i].applies = ahead > 0 && behind > 0;
    out[i].broken = out[i].applies && !hit.valid();
    if (story != nullptr)
      *story = {text(hit), fmt::format("{} of {} triangles crossed ahead, {} behind", ahead, triangles.size(), behind)};
  }
}

/// A matrix that is turned, scaled and turned again, of a condition up to 10^8, with a translation of any size or none.
scene::Affine thin_placement(CaseRandom& random) {
  const auto turn = [&] {
    return random.below(5) ? rotation(random_direction(random), 360.0 * random.uniform()) : DMat3(1.0);
  };
  const double thin = log_uniform(random, 1e-8, 1), size = std::ldexp(1.0, static_cast<int>(random.below(40)) - 20);
  DVec3 scale(size * thin, random.below(2) ? size : size * log_uniform(random, thin, 1), size);
  if (random.below(4) == 0) scale.x = -scale.x;
  const DMat3 second = turn(), first = turn();
  const DVec3 away = random.below(2) ? DVec3(0) : size * log_uniform(random, 1e-3, 1e6) * random_direction(random);
  return {Mat3(second * DMat3(scale.x, 0, 0, 0, scale.y, 0, 0, 0, scale.z) * first), Vec3(away)};
}

CaseValues make_placed_mesh(CaseRandom& random) {
  const scene::Affine m = thin_placement(random);
  const std::size_t sides = 5 + random.below(kMostRing - 5 + 1);
  const std::vector<Vec3> corners = bipyramid_corners(sides, random, [](const DVec3& p) { return Vec3(p); });
  // Nearer to the middle where the rounding of the origin, in the world, takes it farther in the model.
  const double condition = skeel_condition(DMat3(m.linear));
  const DVec3 inside = random.below(4) == 0 ? DVec3(0)
                                            : DVec3(random.in_box(Vec3{-0.1f}, Vec3{0.1f})) *
                                                  std::min(1.0, 0x1p18 / std::max(condition, 1.0));
  const DMat3 linear(m.linear);
  Ray ray;
  ray.origin = Vec3(DVec3(m.translation) + linear * inside);
  ray.direction = Vec3(linear * (DVec3(edge_point(corners, random).at) - inside));
  CaseWriter out;
  out.add(ray).add(m);
  for (const Vec3& corner : corners) out.add(corner);
  return out.take();
}

/// How far a point inside of the mesh is from its surface, or less.
double depth(const std::vector<Corners>& triangles, const DVec3& p) {
  double least = HUGE_VAL;
  for (const Corners& c : triangles) {
    const DVec3 normal = glm::cross(DVec3(c[1]) - DVec3(c[0]), DVec3(c[2]) - DVec3(c[0]));
    least = std::min(least, std::fabs(glm::dot(normal, p - DVec3(c[0]))) / glm::length(normal));
  }
  return least;
}

/// Least depth of the ray's origin inside the mesh, whose size is about 1: nearer to the surface nothing is judged.
constexpr double kLeastDepth = 0x1p-9;

void judge_placed_mesh(const CaseValues& values, std::span<const AccuracyConfig> levels, std::span<Judgement> out,
                       CaseStory* story) {
  CaseReader read(values);
  const Ray ray = read.ray();
  const bool finite = read.rest_is_finite();
  const scene::Affine m = read.placement();
  const Vec3 apex = read.vector(), nadir = read.vector();
  std::vector<Vec3> ring;
  while (read.more()) ring.push_back(read.vector());
  InstanceTransform transform;
  if (!valid(ray) || ray.tmin != 0 || ray.tmax != kInfinity || !finite || !make_transform(m, transform)) return;
  const double condition = skeel_condition(DMat3(m.linear));
  if (!(condition <= kConditionForDouble)) return;
  const std::vector<Corners> triangles = bipyramid(apex, nadir, ring);
  const QuadInverse::Vec at = QuadInverse(m).point(ray.origin);
  if (depth(triangles, {static_cast<double>(at[0]), static_cast<double>(at[1]), static_cast<double>(at[2])}) <
      kLeastDepth)
    return;
  std::size_t ahead = 0, behind = 0;
  for (const Corners& corners : triangles) {
    const std::optional<ExactCrossing> crossing = exact_crossing(ray, corners, m);
    if (!crossing) continue;
    ahead += crossing->compare(0) > 0 && crossing->compare(kFarthest) <= 0;
    behind += crossing->compare(0) < 0;
  }
  if (ahead == 0 || behind == 0) return;
  OneLeaf leaf(triangles);
  for (std::size_t i = 0; i < levels.size(); ++i) {
    if (!leaf.place(m, levels[i].transform)) continue;
    const Hit hit = leaf.hit(ray, levels[i]);
    out[i].applies = true;
    out[i].broken = !hit.valid();
    if (story != nullptr)
      *story = {text(hit), fmt::format("{} of {} triangles crossed ahead, {} behind; condition {:.3g}", ahead,
                                       triangles.size(), behind, condition)};
  }
}

}  // namespace

Property closed_mesh_property() {
  return {"closed_mesh",
          4,
          "from inside a closed mesh something is hit",
          "",
          {AccuracyKey::kTriangle, AccuracyKey::kBox},
          ray_and({{"apex", 3}, {"nadir", 3}, {"ring", 3 * kLeastRing, 3 * kMostRing}}),
          [](const AccuracyConfig& level) {
            return level.triangle != TriangleLevel::kFast && level.box != BoxLevel::kPlain;
          },
          make_closed_mesh,
          judge_closed_mesh};
}

Property placed_mesh_property() {
  return {"placed_mesh",
          9,
          "from inside a closed mesh in an instance of condition 2^27 or less, 2^-9 from its surface, something is hit",
          "",
          {AccuracyKey::kTransform},
          {{"origin", 3},
           {"direction", 3},
           {"tmin", 1},
           {"tmax", 1},
           {"linear", 9},
           {"translation", 3},
           {"apex", 3},
           {"nadir", 3},
           {"ring", 3 * kLeastRing, 3 * kMostRing}},
          [](const AccuracyConfig& level) { return level.transform != TransformLevel::kInverseMatrix; },
          make_placed_mesh,
          judge_placed_mesh};
}

}  // namespace carousel::accel
