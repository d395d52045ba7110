#include "accel/structure/program_hits.h"

#include <cmath>
#include <limits>

#include <glm/geometric.hpp>

#include "core/numeric/octahedral.h"
#include "core/program/run.h"

namespace carousel::accel {

namespace {

bool lies_in(const Aabb& box, const Ray& ray, float t) {
  for (int axis = 0; axis < 3; ++axis) {
    const double from = ray.origin[axis], way = double{t} * ray.direction[axis], at = from + way;
    const double lo = box.lo[axis], hi = box.hi[axis];
    const double slack = 0x1p-16 * (hi - lo) + 0x1p-22 * (std::fabs(from) + std::fabs(way));
    if (!(at >= lo - slack && at <= hi + slack)) return false;
  }
  return true;
}

void count_run(const ProgramRun& run, IntersectionCounts& counts) {
  ++counts.programs;
  counts.program_cycles += run.cycles;
  const auto of = [&](OpClass kind) { return run.instructions[static_cast<std::size_t>(kind)]; };
  counts.simple_instructions += of(OpClass::kSimple);
  counts.product_instructions += of(OpClass::kProduct);
  counts.divide_instructions += of(OpClass::kDivide);
  counts.branch_instructions += of(OpClass::kBranch);
}

}  // namespace

ProgramHits program_hits(const RayProgram& program, const Aabb& box, const Ray& ray, IntersectionCounts* counts) {
  const ProgramRun run = run_program(program, ray);
  if (counts != nullptr) count_run(run, *counts);
  ProgramHits out;
  for (std::size_t i = 0; i < run.hits; ++i) {
    const ReportedHit& hit = run.hit[i];
    if (!(hit.t >= ray.tmin && hit.t <= ray.tmax && hit.t <= std::numeric_limits<float>::max())) continue;
    const DVec3 normal(hit.normal);
    const double length = std::sqrt(glm::dot(normal, normal));
    if (!(length > 0 && length <= std::numeric_limits<double>::max()) || !lies_in(box, ray, hit.t)) continue;
    const double facing = glm::dot(normal, DVec3(ray.direction));
    out.hit[out.count++] = {hit.t, octahedral(normal / length), facing < 0 ? 1 : facing > 0 ? -1 : 0};
  }
  return out;
}

}  // namespace carousel::accel
