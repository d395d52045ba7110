#include <algorithm>
#include <cmath>

#include <fmt/format.h>
#include <glm/matrix.hpp>

#include "accel/certificate/case_values.h"
#include "accel/certificate/kernel_answers.h"
#include "accel/certificate/placement_cases.h"
#include "accel/certificate/properties.h"
#include "accel/certificate/quad_inverse.h"
#include "accel/exact/dyadic.h"
#include "accel/transform/transform.h"
#include "core/numeric/rounding.h"

namespace carousel::accel {

namespace {

/// Largest condition of a matrix whose inverse is judged: beyond it, double arithmetic is too inaccurate to judge by.
constexpr double kWorstCondition = 0x1p24;
double condition(const Mat3& linear) {
  const DMat3 m(linear), inverse = glm::inverse(m);
  double forth = 0, back = 0;
  for (int c = 0; c < 3; ++c)
    for (int row = 0; row < 3; ++row)
      forth = std::max(forth, std::fabs(m[c][row])), back = std::max(back, std::fabs(inverse[c][row]));
  return forth * back;
}

/// Error bound of a level. Two-step rounds the entries of R^-1 (computed in double), each product and two sums, and for
/// a point the difference: gamma(n) times the sum of the terms' magnitudes, which is at most sqrt(3) times the result
/// if R is S Rot. In double there is one rounding, and the error of inverting a matrix of that condition in double. A
/// transpose replaces an inverse from which it differs by the entries of R^T R - I, each at most 4 u.
double allowed(TransformLevel level, int roundings, double size, double terms) {
  constexpr double kLeast = 0x1p-140;  // near the denormals nothing is relative
  constexpr double kInversion = 0x1p-30;
  if (level == TransformLevel::kTwoStepDouble) return kUnitRoundoff * size + kInversion * terms + kLeast;
  const double off = (gamma(roundings) + kInversion) * terms + kLeast;
  return level == TransformLevel::kTransposeIfRotation ? off + 12 * kUnitRoundoff * size : off;
}

CaseValues make_transform_case(CaseRandom& random) {
  const scene::Affine m = placement_case(random);
  const std::uint32_t how = random.below(8);
  const DVec3 offset = how == 0 ? DVec3(0) : log_uniform(random, 1e-3, 1e6) * random_direction(random);
  Vec3 p(DVec3(m.translation) + offset);
  if (how == 1) p = nudged(m.translation, 3, random);
  return CaseWriter().add(m).add(p).add(Vec3(log_uniform(random, 1e-3, 1e3) * random_direction(random))).take();
}

std::string quad_text(const QuadInverse::Vec& v) {
  return fmt::format("({:.17g}, {:.17g}, {:.17g})", static_cast<double>(v[0]), static_cast<double>(v[1]),
                     static_cast<double>(v[2]));
}

void judge_transform(const CaseValues& values, std::span<const AccuracyConfig> levels, std::span<Judgement> out,
                     CaseStory* story) {
  CaseReader read(values);
  const bool finite = read.rest_is_finite();
  const scene::Affine m = read.placement();
  const Vec3 point = read.vector(), direction = read.vector();
  InstanceTransform transform;
  if (!finite || !make_transform(m, transform) || !(condition(m.linear) <= kWorstCondition)) return;
  const QuadInverse of_points(m), of_directions({m.linear, Vec3(0)});
  const QuadInverse::Vec origin = of_points.point(point), along = of_directions.point(direction);
  const double size = QuadInverse::norm(origin), length = QuadInverse::norm(along);
  const double origin_terms = QuadInverse::norm(of_points.terms(point)),
               along_terms = QuadInverse::norm(of_directions.terms(direction));
  for (std::size_t i = 0; i < levels.size(); ++i) {
    if (!make_transform(m, transform, levels[i].transform)) continue;
    const TransformLevel level = level_for(m.linear, levels[i].transform);
    const Ray model = transform.to_model({point, 0, direction, kInfinity});
    const double off = QuadInverse::distance(model.origin, origin),
                 turned = QuadInverse::distance(model.direction, along);
    out[i].applies = true;
    // A position that is no ray's origin, such as a light's, is the same point.
    out[i].broken = !(off <= allowed(level, 5, size, origin_terms)) ||
                    !(turned <= allowed(level, 4, length, along_terms)) ||
                    transform.position_to_model(point) != model.origin;
    if (size > 0) out[i].error = off / size;
    if (story != nullptr)
      *story = {fmt::format("origin {}, direction {}", text(model.origin), text(model.direction)),
                fmt::format("origin {}, off by {:.3g} of {:.3g} allowed; direction {}, off by {:.3g} of {:.3g} allowed",
                            quad_text(origin), off, allowed(level, 5, size, origin_terms), quad_text(along), turned,
                            allowed(level, 4, length, along_terms))};
  }
}

CaseValues make_world_box(CaseRandom& random) {
  const scene::Affine m = placement_case(random);
  const double size = log_uniform(random, 1e-3, 1e3);
  const Vec3 centre(random.below(2) ? DVec3(0) : size * 100.0 * random_direction(random));
  Aabb box;
  for (int corner = 0; corner < (random.below(8) ? 2 : 1); ++corner)
    box.extend(centre + Vec3(size * random_direction(random)));
  Vec3 p;
  for (int axis = 0; axis < 3; ++axis) {
    const std::uint32_t where = random.below(5);
    p[axis] = where < 2   ? box.lo[axis]
              : where < 4 ? box.hi[axis]
                          : std::min(box.hi[axis], std::max(box.lo[axis], random.uniform(box.lo[axis], box.hi[axis])));
  }
  return CaseWriter().add(m).add(box).add(p).take();
}

void judge_world_box(const CaseValues& values, std::span<const AccuracyConfig> levels, std::span<Judgement> out,
                     CaseStory* story) {
  CaseReader read(values);
  const bool finite = read.rest_is_finite();
  const scene::Affine m = read.placement();
  const Aabb model = read.box();
  const Vec3 p = read.vector();
  InstanceTransform transform;
  if (!finite || model.empty()) return;
  for (int axis = 0; axis < 3; ++axis)
    if (p[axis] < model.lo[axis] || p[axis] > model.hi[axis]) return;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    if (!make_transform(m, transform, levels[i].transform)) continue;
    const Aabb box = world_box(m, model, levels[i].transform);
    out[i].applies = true;
    DVec3 rounded;
    for (int row = 0; row < 3; ++row) {
      Dyadic x(m.translation[row]);
      for (int c = 0; c < 3; ++c) x = x + Dyadic(m.linear[c][row]) * Dyadic(p[c]);
      const auto outside = [&](float plane, int side) {
        return std::isfinite(plane) && (x - Dyadic(plane)).sign() * side > 0;
      };
      out[i].broken |=
          std::isnan(box.lo[row]) || std::isnan(box.hi[row]) || outside(box.lo[row], -1) || outside(box.hi[row], 1);
      rounded[row] = rounded_ratio<double>(x, Dyadic(1));
    }
    if (story != nullptr)
      *story = {"box from " + text(box.lo) + " to " + text(box.hi),
                fmt::format("the point is at ({:.17g}, {:.17g}, {:.17g})", rounded.x, rounded.y, rounded.z)};
  }
}

}  // namespace

Property transform_property() {
  return {"transform",
          5,
          "origin, any position and direction in model space are off by no more than the level's bound",
          "of the origin's length",
          {AccuracyKey::kTransform},
          {{"linear", 9}, {"translation", 3}, {"point", 3}, {"direction", 3}},
          [](const AccuracyConfig& level) { return level.transform != TransformLevel::kInverseMatrix; },
          make_transform_case,
          judge_transform};
}

Property world_box_property() {
  return {"world_box",
          6,
          "an instance's world box holds every point of its model's box",
          "",
          {AccuracyKey::kTransform},
          {{"linear", 9}, {"translation", 3}, {"lo", 3}, {"hi", 3}, {"point", 3}},
          [](const AccuracyConfig&) { return true; },
          make_world_box,
          judge_world_box};
}

}  // namespace carousel::accel
