#include "accel/plane_candidates.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace carousel::accel {

namespace {

/// Less than this is not worth a test.
constexpr double kLeastEmptyPart = 1.0 / 256;

/// A direction as a plane's normal: the sum of its entries' magnitudes just below 1. False when it has none.
bool set_normal(const DVec3& direction, CullPlane& plane) {
  const double sum = std::fabs(direction.x) + std::fabs(direction.y) + std::fabs(direction.z);
  if (!(sum > 0) || !std::isfinite(sum)) return false;
  for (int axis = 0; axis < 3; ++axis) plane.normal[axis] = static_cast<float>(direction[axis] / sum * (1 - 0x1p-22));
  return true;
}

/// A normal without an entry along an axis belongs to the octants on both sides.
bool in_octant(const CullPlane& plane, std::size_t octant) {
  for (int axis = 0; axis < 3; ++axis)
    if ((octant >> axis & 1u) != 0 ? plane.normal[axis] > 0 : plane.normal[axis] < 0) return false;
  return true;
}

}  // namespace

float distance_along(const CullPlane& plane, const Aabb& box, const std::vector<Vec3>& points) {
  const float* const n = plane.normal;
  const DVec3 centre(plane_centre(box.lo.x, box.hi.x), plane_centre(box.lo.y, box.hi.y), plane_centre(box.lo.z, box.hi.z));
  double most = -std::numeric_limits<double>::infinity(), error = 0;
  for (const Vec3& p : points) {
    const double x = n[0] * (p.x - centre.x), y = n[1] * (p.y - centre.y), z = n[2] * (p.z - centre.z);
    most = std::fmax(most, x + y + z);
    error = std::fmax(error, std::fabs(x) + std::fabs(y) + std::fabs(z));
  }
  // Each term is a rounded difference and product, in two sums; denormals of double are below every float.
  most += 0x1p-50 * error;
  float distance = static_cast<float>(most);
  if (distance < most) distance = std::nextafter(distance, std::numeric_limits<float>::infinity());
  return distance;
}

// A corner is a simplex, less the simplices that stick out beyond the box's other faces (inclusion and exclusion).
double empty_part(const CullPlane& plane, const Aabb& box) {
  std::array<double, 3> side{};
  double whole = 0;
  for (int axis = 0; axis < 3; ++axis) {
    side[static_cast<std::size_t>(axis)] = std::fabs(plane.normal[axis]) * (double(box.hi[axis]) - box.lo[axis]);
    whole += side[static_cast<std::size_t>(axis)];
  }
  const double depth = whole / 2 - plane.distance;   // from the corner that is farthest along the normal
  if (!(depth > 0)) return 0;
  for (double& s : side) s = std::fmax(s, 1e-4 * whole);   // nearly parallel to an axis: the sum below would cancel
  double volume = 0;
  for (unsigned corner = 0; corner < 8; ++corner) {
    double left = depth;
    for (unsigned axis = 0; axis < 3; ++axis)
      if (corner >> axis & 1u) left -= side[axis];
    if (left > 0) volume += (__builtin_popcount(corner) % 2 == 0 ? 1 : -1) * left * left * left;
  }
  return std::clamp(volume / (6 * side[0] * side[1] * side[2]), 0.0, 1.0);
}

void PlaneChoice::offer(const DVec3& direction) {
  Candidate candidate;
  if (!set_normal(direction, candidate.plane)) return;
  candidate.plane.distance = distance_along(candidate.plane, box_, points_);
  if (!std::isfinite(candidate.plane.distance)) return;
  candidate.empty = empty_part(candidate.plane, box_);
  for (std::size_t i = 0; i < octants_.size(); ++i)
    if (in_octant(candidate.plane, i) && candidate.empty > octants_[i].empty) octants_[i] = candidate;
}

void PlaneChoice::offer_octants() {
  DVec3 direction;
  for (int axis = 0; axis < 3; ++axis) {
    const double extent = double(box_.hi[axis]) - box_.lo[axis];
    if (!(extent > 0)) return;   // flat: nothing to cut off
    direction[axis] = 1 / extent;
  }
  for (int signs = 0; signs < 8; ++signs)
    offer({signs & 1 ? -direction.x : direction.x, signs & 2 ? -direction.y : direction.y,
           signs & 4 ? -direction.z : direction.z});
}

std::vector<CullPlane> PlaneChoice::best(int most) const {
  std::array<Candidate, 8> sorted = octants_;
  std::stable_sort(sorted.begin(), sorted.end(), [](const Candidate& a, const Candidate& b) { return a.empty > b.empty; });
  std::vector<CullPlane> planes;
  for (const Candidate& candidate : sorted) {
    const bool again = !planes.empty() && planes.back() == candidate.plane;   // the best of several octants
    if (static_cast<int>(planes.size()) < most && candidate.empty > kLeastEmptyPart && !again)
      planes.push_back(candidate.plane);
  }
  return planes;
}

}  // namespace carousel::accel
