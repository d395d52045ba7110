#include <cmath>

#include <fmt/format.h>

#include "accel/certificate/box_cases.h"
#include "accel/certificate/case_values.h"
#include "accel/certificate/exact_box.h"
#include "accel/certificate/kernel_answers.h"
#include "accel/certificate/properties.h"
#include "accel/traverse/ray_check.h"

namespace carousel::accel {

namespace {

bool usable(const Ray& ray, const Aabb& box) {
  for (int axis = 0; axis < 3; ++axis)
    if (!std::isfinite(box.lo[axis]) || !std::isfinite(box.hi[axis])) return false;
  return valid(ray) && std::isfinite(ray.tmin) && !box.empty();
}

/// The range in which `conservative` makes its promise: no difference overflows, and no distance is so small and no
/// reciprocal so near to the denormals that a relative widening could have no effect.
bool in_range_of_floats(const Ray& ray, const Aabb& box) {
  for (int axis = 0; axis < 3; ++axis) {
    const float d = std::fabs(ray.direction[axis]);
    if (d > 0x1p125f) return false;
    for (const float plane : {box.lo[axis], box.hi[axis]}) {
      const float away = std::fabs(plane - ray.origin[axis]);
      if (!std::isfinite(away) || (d != 0 && away != 0 && double{away} / d < 0x1p-100)) return false;
    }
  }
  return true;
}

std::string described(const BoxAnswer& answer) {
  return answer.hit ? "hit, entered at " + text(answer.entry) : std::string("missed");
}
std::string described(const ExactBox& exact) {
  return exact.hit() ? fmt::format("met, entered at {:.17g}", exact.entry()) : std::string("not met");
}

/// Mostly of a modest range; now and then of any exponent, for what promises something even there.
BoxCase make_case(CaseRandom& random) {
  const bool wild = random.below(4) == 0;
  BoxCase c = box_case(random, wild ? 100 : 20, wild ? 140 : 10);
  if (random.below(16) == 0) {
    c.ray.tmin = random.uniform();
    c.ray.tmax = c.ray.tmin + 2 * random.uniform();
  }
  return c;
}

CaseValues make_box(CaseRandom& random) {
  const BoxCase c = make_case(random);
  return CaseWriter().add(c.ray).add(c.box).take();
}

void judge_box(const CaseValues& values, std::span<const AccuracyConfig> levels, std::span<Judgement> out,
               CaseStory* story) {
  CaseReader read(values);
  const Ray ray = read.ray();
  const Aabb box = read.box();
  if (!usable(ray, box)) return;
  const ExactBox exact(ray, box, ray.tmax);
  const bool modest = in_range_of_floats(ray, box);
  for (std::size_t i = 0; i < levels.size(); ++i) {
    out[i].applies = exact.hit() && (modest || levels[i].box == BoxLevel::kDouble);
    if (!out[i].applies && story == nullptr) continue;
    const BoxAnswer answer = box_answers(levels[i].box, ray, {&box, 1})[0];
    out[i].broken = out[i].applies && !answer.hit;
    if (story != nullptr) *story = {described(answer), described(exact)};
  }
}

CaseValues make_nested(CaseRandom& random) {
  const BoxCase c = make_case(random);
  Aabb outer = c.box;
  const Vec3 size = c.box.extent();
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 2; ++side) {
      const std::uint32_t how = random.below(4);  // 0 keeps the face, 1 to 3 move it far, a little, or a few floats
      if (how == 0) continue;
      float& plane = side ? outer.hi[axis] : outer.lo[axis];
      const float away = how == 1 ? size[axis] : how == 2 ? std::fabs(plane) * 0x1p-10f : 0.0f;
      plane += (side ? away : -away) * random.uniform();
      for (std::uint32_t ulps = random.below(3); ulps > 0; --ulps)
        plane = std::nextafter(plane, side ? kInfinity : -kInfinity);
    }
  }
  return CaseWriter().add(c.ray).add(c.box).add(outer).take();
}

void judge_nested(const CaseValues& values, std::span<const AccuracyConfig> levels, std::span<Judgement> out,
                  CaseStory* story) {
  CaseReader read(values);
  const Ray ray = read.ray();
  const Aabb boxes[2] = {read.box(), read.box()};
  if (!usable(ray, boxes[0]) || !usable(ray, boxes[1])) return;
  for (int axis = 0; axis < 3; ++axis)
    if (boxes[1].lo[axis] > boxes[0].lo[axis] || boxes[1].hi[axis] < boxes[0].hi[axis]) return;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    const auto answers = box_answers(levels[i].box, ray, boxes);
    out[i].applies = answers[0].hit;
    out[i].broken = answers[0].hit && !(answers[1].hit && answers[1].entry <= answers[0].entry);
    if (story != nullptr)
      *story = {"inner box " + described(answers[0]) + "; outer box " + described(answers[1]),
                "inner box " + described(ExactBox(ray, boxes[0], ray.tmax)) + "; outer box " +
                    described(ExactBox(ray, boxes[1], ray.tmax))};
  }
}

}  // namespace

Property box_property() {
  return {"box",
          1,
          "a box that the exact ray meets is hit",
          "",
          {AccuracyKey::kBox},
          ray_and({{"lo", 3}, {"hi", 3}}),
          [](const AccuracyConfig& level) { return level.box != BoxLevel::kPlain; },
          make_box,
          judge_box};
}

Property nested_boxes_property() {
  return {"nested_boxes",
          2,
          "a box around a box that is hit is hit, and entered no later",
          "",
          {AccuracyKey::kBox},
          ray_and({{"lo", 3}, {"hi", 3}, {"outer_lo", 3}, {"outer_hi", 3}}),
          [](const AccuracyConfig&) { return true; },
          make_nested,
          judge_nested};
}

}  // namespace carousel::accel
