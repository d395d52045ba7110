#include "accel/structure/bounding_spheres.h"

#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "accel/structure/accel.h"
#include "accel/structure/cull_plane.h"
#include "accel/planes/plane_candidates.h"
#include "accel/structure/sphere.h"

namespace carousel::accel {

namespace {

constexpr double kSlack = 0x1p-18;   // of the distance, see the header
constexpr double kLeast = 0x1p-120;  // where reciprocals overflow

double farthest_corner2(const DVec3& centre, const Aabb& box) {
  const DVec3 lo = centre - DVec3(box.lo), hi = DVec3(box.hi) - centre, far = glm::max(glm::abs(lo), glm::abs(hi));
  return glm::dot(far, far);
}

void raise(const Accel& accel, const Node& node, int lane, const DVec3& centre, double& most) {
  const Aabb box = child_box(node, lane);
  // Nothing below can reach farther than the box does.
  if (farthest_corner2(centre, box) <= most) return;
  const NodeRef child = node.child[lane];
  if (child.is_inner()) {
    const Node& below = accel.nodes[child.node()];
    for (int l = 0; l < below.count; ++l) raise(accel, below, l, centre, most);
    return;
  }
  if (child.is_instance()) {
    most = std::max(most, farthest_corner2(centre, box));
    return;
  }
  for (std::uint32_t i = 0; i < child.triangles(); ++i) {
    const TriangleBlock& block = accel.blocks[child.first_block() + i / kBlockTriangles];
    Aabb primitive;
    if (child.is_procedural()) {
      const BlockSphere sphere = sphere_in(block, i % kBlockTriangles);
      primitive = sphere_box(sphere.centre, sphere.radius);
    } else {
      for (const auto& v : block.vertex)
        primitive.extend(Vec3{v[0][i % kBlockTriangles], v[1][i % kBlockTriangles], v[2][i % kBlockTriangles]});
    }
    most = std::max(most, farthest_corner2(centre, primitive));
  }
}

float rounded_down(double x) {
  const float near = static_cast<float>(x);
  return double{near} > x ? std::nextafter(near, -kInfinity) : near;
}

}  // namespace

std::vector<NodeSpheres> bounding_spheres(const Accel& accel, Executor& executor) {
  std::vector<NodeSpheres> all(accel.nodes.size());
  executor.parallel_for(all.size(), 64, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      const Node& node = accel.nodes[i];
      for (int lane = 0; lane < kMaxWidth; ++lane) {
        const Vec3 centre = lane < node.count ? child_box(node, lane).centre() : Vec3{0};
        for (int axis = 0; axis < 3; ++axis) all[i].centre[axis][lane] = centre[axis];
        double most = 0;
        if (lane < node.count) raise(accel, node, lane, DVec3(centre), most);
        all[i].radius[lane] = rounded_up(std::sqrt(most) * (1 + 0x1p-50));
      }
    }
  });
  return all;
}

std::uint32_t meet_spheres(const NodeSpheres& spheres, int count, const Vec3& origin, const Vec3& direction, float tmin,
                           float tmax, float* entry) {
  const DVec3 o(origin), d(direction);
  const double a = glm::dot(d, d);
  std::uint32_t mask = 0;
  for (int lane = 0; lane < count; ++lane) {
    const DVec3 to = DVec3(spheres.centre[0][lane], spheres.centre[1][lane], spheres.centre[2][lane]) - o;
    const double t = glm::dot(to, d) / a, radius = spheres.radius[lane];
    const double far = std::sqrt(glm::dot(to, to)) + radius, r = radius + kSlack * far + kLeast;
    const DVec3 aside = to - t * d;
    const double half_chord2 = r * r - glm::dot(aside, aside);
    // Comparisons that NaN passes: it comes of infinities, and then nothing is known.
    if (half_chord2 < 0) continue;
    const double half_chord = std::sqrt(half_chord2 / a), in = t - half_chord, out = t + half_chord;
    if (out < tmin || in > tmax) continue;
    mask |= 1u << lane;
    entry[lane] = in > tmin ? rounded_down(in) : tmin;
  }
  return mask;
}

}  // namespace carousel::accel
