#include "accel/planes/second_sphere.h"

#include <cmath>
#include <limits>

#include <glm/geometric.hpp>

#include "core/numeric/rounding.h"

namespace carousel::accel {

namespace {

constexpr int kSteps = 64;
constexpr int kCells = 8;                                  // cells of the box along an axis; those outside are counted
constexpr int kLeastOff = kCells * kCells * kCells / 256;  // cells to cut off at least, a part as for planes
constexpr double kDistanceRounding = 1 + 0x1p-48;          // covers the rounding of sums, squares and a root

class Enclosed {
 public:
  Enclosed(const std::vector<Vec3>& points, const std::vector<BlockSphere>& spheres)
      : points_(points), spheres_(spheres) {}

  struct Farthest {
    double distance = 0;
    DVec3 centre{0, 0, 0};  // centre of the farthest point or sphere
  };
  Farthest farthest_from(const DVec3& from) const {
    Farthest most;
    const auto offer = [&](const Vec3& centre, float radius) {
      const double distance = glm::length(DVec3(centre) - from) + static_cast<double>(radius);
      if (distance > most.distance) most = {distance, DVec3(centre)};
    };
    for (const Vec3& point : points_) offer(point, 0);
    for (const BlockSphere& sphere : spheres_) offer(sphere.centre, sphere.radius);
    return most;
  }

 private:
  const std::vector<Vec3>& points_;
  const std::vector<BlockSphere>& spheres_;
};

int cells_outside(const DVec3& centre, double radius, const Aabb& box) {
  const DVec3 lo(box.lo), step = (DVec3(box.hi) - lo) / static_cast<double>(kCells);
  int outside = 0;
  for (int i = 0; i < kCells * kCells * kCells; ++i) {
    const DVec3 cell(i % kCells, i / kCells % kCells, i / kCells / kCells);
    outside += glm::length(lo + (cell + 0.5) * step - centre) > radius;
  }
  return outside;
}

}  // namespace

std::optional<CullPlane> second_sphere(const std::vector<Vec3>& points, const std::vector<BlockSphere>& spheres,
                                       const Aabb& box) {
  const Enclosed all(points, spheres);
  // Badoiu and Clarkson, "Smaller Core-Sets for Balls", SODA 2003: each time a smaller step towards the farthest.
  DVec3 centre = 0.5 * DVec3(box.lo) + 0.5 * DVec3(box.hi);
  for (int i = 1; i <= kSteps; ++i) centre += (all.farthest_from(centre).centre - centre) / (i + 1.0);
  CullPlane sphere;
  for (int axis = 0; axis < 3; ++axis) sphere.normal[axis] = static_cast<float>(centre[axis]);
  centre = {sphere.normal[0], sphere.normal[1], sphere.normal[2]};
  sphere.distance = rounded_up(all.farthest_from(centre).distance * kDistanceRounding);
  if (!(sphere.distance < std::numeric_limits<float>::infinity())) return std::nullopt;
  if (cells_outside(centre, sphere.distance, box) < kLeastOff) return std::nullopt;
  return sphere;
}

}  // namespace carousel::accel
