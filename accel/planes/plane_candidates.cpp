#include "accel/planes/plane_candidates.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/geometric.hpp>

#include "core/numeric/rounding.h"

namespace carousel::accel {

namespace {

/// Less than this is not worth a test.
constexpr double kLeastEmptyPart = 1.0 / 256;

bool in_octant(const CullPlane& plane, std::size_t octant) {
  for (int axis = 0; axis < 3; ++axis)
    if ((octant >> axis & 1u) != 0 ? plane.normal[axis] > 0 : plane.normal[axis] < 0) return false;
  return true;
}

}  // namespace

bool set_normal(const DVec3& direction, CullPlane& plane) {
  const double sum = std::fabs(direction.x) + std::fabs(direction.y) + std::fabs(direction.z);
  if (!(sum > 0) || !std::isfinite(sum)) return false;
  for (int axis = 0; axis < 3; ++axis) plane.normal[axis] = static_cast<float>(direction[axis] / sum * (1 - 0x1p-22));
  return true;
}

float distance_along(const CullPlane& plane, const Aabb& box, const std::vector<Vec3>& points) {
  const float* const n = plane.normal;
  const DVec3 centre(plane_centre(box.lo.x, box.hi.x), plane_centre(box.lo.y, box.hi.y),
                     plane_centre(box.lo.z, box.hi.z));
  double most = -std::numeric_limits<double>::infinity(), error = 0;
  for (const Vec3& p : points) {
    const double x = n[0] * (p.x - centre.x), y = n[1] * (p.y - centre.y), z = n[2] * (p.z - centre.z);
    most = std::fmax(most, x + y + z);
    error = std::fmax(error, std::fabs(x) + std::fabs(y) + std::fabs(z));
  }
  // Each term is a rounded difference and product, in two sums; denormals of double are below every float.
  return rounded_up(most + 0x1p-50 * error);
}

float distance_along(const CullPlane& plane, const Aabb& box, const Vec3& sphere, float radius) {
  const DVec3 n = normal_of(plane);
  const DVec3 centre(plane_centre(box.lo.x, box.hi.x), plane_centre(box.lo.y, box.hi.y),
                     plane_centre(box.lo.z, box.hi.z));
  const DVec3 terms = n * (DVec3(sphere) - centre);
  const double reach = radius * glm::length(n);
  const double error = std::fabs(terms.x) + std::fabs(terms.y) + std::fabs(terms.z) + reach;
  return rounded_up(terms.x + terms.y + terms.z + reach + 0x1p-49 * error);
}

// A corner is a simplex, less the simplices that stick out beyond the box's other faces (inclusion and exclusion).
double empty_part(const CullPlane& plane, const Aabb& box) {
  std::array<double, 3> side{};
  double whole = 0;
  for (int axis = 0; axis < 3; ++axis) {
    side[static_cast<std::size_t>(axis)] = std::fabs(plane.normal[axis]) * (double(box.hi[axis]) - box.lo[axis]);
    whole += side[static_cast<std::size_t>(axis)];
  }
  const double depth = whole / 2 - plane.distance;  // from the corner that is farthest along the normal
  if (!(depth > 0)) return 0;
  for (double& s : side) s = std::fmax(s, 1e-4 * whole);  // nearly parallel to an axis: the sum below would cancel
  double volume = 0;
  for (unsigned corner = 0; corner < 8; ++corner) {
    double left = depth;
    for (unsigned axis = 0; axis < 3; ++axis)
      if (corner >> axis & 1u) left -= side[axis];
    if (left > 0) volume += (__builtin_popcount(corner) % 2 == 0 ? 1 : -1) * left * left * left;
  }
  return std::clamp(volume / (6 * side[0] * side[1] * side[2]), 0.0, 1.0);
}

void OctantBest::offer(const CullPlane& plane, double worth) {
  for (std::size_t i = 0; i < octants_.size(); ++i)
    if (in_octant(plane, i) && worth > octants_[i].worth) octants_[i] = {plane, worth};
}

std::vector<CullPlane> OctantBest::best(int most, double least) const {
  std::array<Candidate, 8> sorted = octants_;
  std::stable_sort(sorted.begin(), sorted.end(),
                   [](const Candidate& a, const Candidate& b) { return a.worth > b.worth; });
  std::vector<CullPlane> planes;
  for (const Candidate& candidate : sorted) {
    const bool again = !planes.empty() && planes.back() == candidate.plane;  // the best of several octants
    if (static_cast<int>(planes.size()) < most && candidate.worth > least && !again) planes.push_back(candidate.plane);
  }
  return planes;
}

void PlaneChoice::offer(const DVec3& direction) {
  CullPlane plane{};
  if (!set_normal(direction, plane)) return;
  plane.distance = child_.distance(plane);
  if (std::isfinite(plane.distance)) best_.offer(plane, empty_part(plane, child_.box));
}

void PlaneChoice::offer_octants() {
  DVec3 direction;
  for (int axis = 0; axis < 3; ++axis) {
    const double extent = double(child_.box.hi[axis]) - child_.box.lo[axis];
    if (!(extent > 0)) return;  // flat: nothing to cut off
    direction[axis] = 1 / extent;
  }
  for (int signs = 0; signs < 8; ++signs)
    offer({signs & 1 ? -direction.x : direction.x, signs & 2 ? -direction.y : direction.y,
           signs & 4 ? -direction.z : direction.z});
}

std::vector<CullPlane> PlaneChoice::best(int most) const {
  return best_.best(most, kLeastEmptyPart);
}

std::vector<std::vector<CullPlane>> shared_planes(const std::vector<BoxedShape>& siblings,
                                                  const std::vector<CullPlane>& candidates, int most) {
  OctantBest choice;
  for (CullPlane plane : candidates) {
    double worth = 0;
    for (const BoxedShape& child : siblings) {
      plane.distance = child.distance(plane);
      worth += child.box.half_area() * empty_part(plane, child.box);
    }
    plane.distance = 0;  // equal directions are equal planes
    choice.offer(plane, worth);
  }
  const std::vector<CullPlane> directions = choice.best(most, 0);
  std::vector<std::vector<CullPlane>> planes;
  for (const BoxedShape& child : siblings) {
    std::vector<CullPlane>& own = planes.emplace_back(directions);
    double empty = 0;
    for (CullPlane& plane : own) {
      plane.distance = child.distance(plane);
      empty = std::fmax(empty, empty_part(plane, child.box));
    }
    if (!(empty > kLeastEmptyPart)) own.clear();
  }
  return planes;
}

}  // namespace carousel::accel
