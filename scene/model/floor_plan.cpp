#include "scene/model/floor_plan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "core/numeric/trigonometry.h"
#include "scene/model/camera_pose.h"

namespace carousel::scene {

namespace {

using DVec2 = glm::dvec2;

/// A wall of the plan in x and z; `front` points to the side that its triangle faces.
struct Wall {
  DVec2 a, b, front;
};

struct Sight {
  double distance = std::numeric_limits<double>::infinity();
  bool front = false;  ///< it ends at the front of a wall
  bool hit() const { return distance < std::numeric_limits<double>::infinity(); }
};

class FloorPlan {
 public:
  FloorPlan(const Scene& scene, double height) {
    for (const Instance& instance : scene.instances) {
      const glm::dmat3 linear(instance.world_from_model.linear);
      const DVec3 offset(instance.world_from_model.translation);
      const double turned = glm::determinant(linear) < 0 ? -1 : 1;  // glTF, 3.7.4: a mirrored instance is turned
      const Mesh& mesh = scene.meshes[instance.mesh.value];
      for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3) {
        DVec3 p[3];
        for (std::size_t c = 0; c < 3; ++c) p[c] = linear * DVec3(mesh.positions[mesh.indices[i + c]]) + offset;
        add(p, turned, height);
      }
    }
  }

  std::size_t size() const { return walls_.size(); }

  /// The first wall from `from` in the direction `to`, which is unit.
  Sight look(const DVec2& from, const DVec2& to) const {
    Sight out;
    for (const Wall& wall : walls_) {
      const DVec2 along = wall.b - wall.a, way = wall.a - from;
      const double cross = to.x * along.y - to.y * along.x;
      if (cross == 0) continue;
      const double distance = (way.x * along.y - way.y * along.x) / cross;
      const double at = (way.x * to.y - way.y * to.x) / cross;
      if (!(distance > 0 && distance < out.distance && at >= 0 && at <= 1)) continue;
      out = {distance, glm::dot(wall.front, to) < 0};
    }
    return out;
  }

 private:
  void add(const DVec3 (&p)[3], double turned, double height) {
    DVec2 cut[2];
    int cuts = 0;
    for (int c = 0; c < 3 && cuts < 2; ++c) {
      const DVec3 &from = p[c], &to = p[(c + 1) % 3];
      if ((from.y < height) == (to.y < height)) continue;
      const DVec3 at = glm::mix(from, to, (height - from.y) / (to.y - from.y));
      cut[cuts++] = {at.x, at.z};
    }
    if (cuts < 2) return;
    const DVec3 normal = turned * glm::cross(p[1] - p[0], p[2] - p[0]);
    walls_.push_back({cut[0], cut[1], {normal.x, normal.z}});
  }

  std::vector<Wall> walls_;
};

DVec2 direction(int i, int count) {
  const auto [y, x] = sin_cos((i + 0.5) * 2 * std::numbers::pi / count);
  return {x, y};
}

/// The share of sight lines from outside, among those that meet the model, that end at the back of a surface.
double backs_seen_from_outside(const FloorPlan& plan, const DVec2& lo, const DVec2& hi) {
  constexpr int kLines = 32;
  int met = 0, backs = 0;
  const DVec2 size = hi - lo;
  const double away = size.x + size.y;
  const auto look = [&](const DVec2& from, const DVec2& to) {
    const Sight sight = plan.look(from, to);
    met += sight.hit();
    backs += sight.hit() && !sight.front;
  };
  for (int i = 0; i < kLines; ++i) {
    const double at = (i + 0.5) / kLines;
    const double x = lo.x + at * size.x, z = lo.y + at * size.y;
    look({lo.x - away, z}, {1, 0});
    look({hi.x + away, z}, {-1, 0});
    look({x, lo.y - away}, {0, 1});
    look({x, hi.y + away}, {0, -1});
  }
  return met == 0 ? 0 : static_cast<double>(backs) / met;
}

struct Place {
  DVec2 at, to;
  double area = 0;  ///< that it overlooks
  double behind = 0, ahead = 0;
};

/// The length of a sight line within the box.
double length_in_box(const Sight& sight, const DVec2& from, const DVec2& to, const DVec2& lo, const DVec2& hi) {
  double out = sight.distance;
  for (int axis = 0; axis < 2; ++axis)
    if (to[axis] != 0) out = std::min(out, ((to[axis] > 0 ? hi[axis] : lo[axis]) - from[axis]) / to[axis]);
  return out;
}

/// The view from places all over the plan: shares of the sight lines, and the place that overlooks most.
struct Survey {
  double hits = 0, fronts = 0;
  std::optional<Place> best;
};

Survey survey(const FloorPlan& plan, const DVec2& lo, const DVec2& hi) {
  constexpr int kPlaces = 7, kDirections = 32;
  std::optional<Place> best;
  int lines = 0, hits = 0, fronts = 0;
  for (int i = 0; i < kPlaces * kPlaces; ++i) {
    Place place{.at = lo + (hi - lo) * (DVec2(i % kPlaces, i / kPlaces) + 0.5) / double(kPlaces), .to = {}};
    double lengths[kDirections];
    int backs = 0, seen = 0;
    for (int d = 0; d < kDirections; ++d) {
      const DVec2 to = direction(d, kDirections);
      const Sight sight = plan.look(place.at, to);
      lengths[d] = length_in_box(sight, place.at, to, lo, hi);
      if (sight.front) place.area += lengths[d] * lengths[d];  // directions that end at no wall's front add no area
      seen += sight.front;
      hits += sight.hit();
      fronts += sight.front;
      backs += sight.hit() && !sight.front;
    }
    lines += kDirections;
    // Among many backs the place is inside a wall or a cupboard; where it sees few fronts it is outside.
    if (backs > kDirections / 4 || seen < kDirections / 2 || (best && best->area >= place.area)) continue;
    for (int d = 0; d < kDirections; ++d) {
      const double ahead = lengths[d], behind = lengths[(d + kDirections / 2) % kDirections];
      if (ahead + behind <= place.ahead + place.behind || ahead < behind) continue;
      place.to = direction(d, kDirections);
      place.ahead = ahead;
      place.behind = behind;
    }
    best = place;
  }
  return {static_cast<double>(hits) / lines, static_cast<double>(fronts) / lines, best};
}

}  // namespace

std::optional<Camera> inside_camera(const Scene& scene) {
  constexpr double kEyeHeight = 0.4, kStepBack = 0.9;
  constexpr double kMostly = 0.5;                                          // walls without an outside
  constexpr double kEnclosed = 2.0 / 3, kInnerWalls = 0.6, kRoomSize = 3;  // walls with an outside; metres
  constexpr float kFieldOfView = 1.05f;
  const Aabb box = scene.bounds();
  if (box.empty()) return std::nullopt;
  const double height = box.lo.y + kEyeHeight * (double(box.hi.y) - box.lo.y);
  const DVec2 lo(box.lo.x, box.lo.z), hi(box.hi.x, box.hi.z);
  if (std::min(hi.x - lo.x, hi.y - lo.y) < kRoomSize) return std::nullopt;
  const FloorPlan plan(scene, height);
  if (plan.size() == 0) return std::nullopt;
  const bool thin = backs_seen_from_outside(plan, lo, hi) >= kMostly;
  const auto [hits, fronts, place] = survey(plan, lo, hi);
  const bool inside = thin ? fronts >= kMostly : hits >= kEnclosed && fronts >= kInnerWalls * hits;
  if (!inside || !place || !(place->ahead > 0)) return std::nullopt;
  const DVec2 eye = place->at - kStepBack * place->behind * place->to, target = place->at + place->ahead * place->to;
  const Vec3 from(eye.x, height, eye.y), to(target.x, height, target.y);
  if (from == to) return std::nullopt;
  Camera camera = look_at(from, to, kFieldOfView);
  camera.name = "inside";
  return camera;
}

}  // namespace carousel::scene
