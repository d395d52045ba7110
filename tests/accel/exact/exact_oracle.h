#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include <boost/multiprecision/cpp_int.hpp>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

#include "core/types/ray.h"
#include "scene/model/scene.h"

namespace carousel::accel {

/// Judges a claimed closest hit by exact arithmetic on the scene's and the ray's own floats: every float is an
/// integer times 2^-149 and every transformed vertex one times 2^-298, so sides, inside or outside, and the
/// order of two hits along a ray are decided without any rounding.
///
/// The kernels round, so an answer need not be that of the exact ray; it has to be that of an exact ray no
/// farther away than the documented bound: kFarWidening's 16 u of the distance to the triangle (accel/box/slab.h),
/// and for instances the condition of the transform times the rounding of its two steps. A leak through an edge
/// that two triangles share is no such answer, since every ray nearby hits one of them.
class ExactOracle {
 public:
  explicit ExactOracle(const scene::Scene& scene) {
    for (std::uint32_t i = 0; i < scene.instances.size(); ++i) {
      const scene::Affine& m = scene.instances[i].world_from_model;
      const scene::Mesh& mesh = scene.meshes[scene.instances[i].mesh.value];
      Frame frame;
      frame.first = triangles_.size();
      frame.identity = m.linear == Mat3(1.0f) && m.translation == Vec3(0.0f);
      frame.translation = DVec3(m.translation);
      if (!frame.identity) {
        frame.model_from_world = glm::inverse(DMat3(m.linear));
        frame.condition = norm(DMat3(m.linear)) * norm(frame.model_from_world);
      }
      for (std::uint32_t t = 0; t < mesh.triangle_count(); ++t) {
        Triangle triangle{i, t, {}, {}, DVec3(0), 0};
        for (std::uint32_t k = 0; k < 3; ++k) {
          triangle.model[k] = mesh.positions[mesh.indices[3 * t + k]];
          triangle.world[k] = DMat3(m.linear) * DVec3(triangle.model[k]) + DVec3(m.translation);
        }
        triangle.centre = (triangle.world[0] + triangle.world[1] + triangle.world[2]) / 3.0;
        for (const DVec3& p : triangle.world)
          triangle.radius = std::max(triangle.radius, glm::length(p - triangle.centre));
        triangles_.push_back(triangle);
      }
      frames_.push_back(frame);
      placements_.push_back(m);
    }
  }

  /// True if `hit` is the exact closest hit of some ray within the bound of `ray` (closest hit, tmin = 0, tmax =
  /// infinity).
  bool acceptable(const Ray& ray, const Hit& hit) const {
    const DVec3 o(ray.origin), d(ray.direction);
    double limit = 1e300;
    if (hit.valid()) {
      const Triangle& claimed = triangles_[frames_[hit.instance].first + hit.primitive];
      const double delta = bound(claimed, o), slack = t_slack(claimed, o, d, delta);
      if (!near_triangle(exact(ray, claimed), claimed, d, delta)) return false;
      const double t = plane_t(claimed, o, d);
      if (!(std::fabs(hit.t - t) <= slack)) return false;
      limit = hit.t - slack;
    }
    // Is there a ray within the bound with nothing in front?
    const std::vector<const Triangle*> blockers = near_line(o, d, limit);
    double delta = 0;
    for (const Triangle* b : blockers) delta = std::max(delta, bound(*b, o));
    const DVec3 axis = std::fabs(d.x) < std::fabs(d.y) ? DVec3(1, 0, 0) : DVec3(0, 1, 0);
    const DVec3 e1 = glm::normalize(glm::cross(d, axis)), e2 = glm::normalize(glm::cross(d, e1));
    // Where needles lie thick, a ray at the bound's end meets other ones than a ray nearby: near ones are tried too.
    constexpr int kWays = 16, kRings = 5;
    for (int way = -1; way < kWays * kRings; ++way) {
      const double angle = 6.283185307179586 * way / kWays, away = std::ldexp(delta, -3 * (way / kWays));
      const DVec3 offset = way < 0 ? DVec3(0) : away * (std::cos(angle) * e1 + std::sin(angle) * e2);
      bool blocked = false;
      for (const Triangle* b : blockers) {
        if (!blocks(exact(ray, *b, offset), *b, o, d, limit)) continue;
        blocked = true;
        break;
      }
      if (!blocked) return true;
    }
    return false;
  }

 private:
  using Int = boost::multiprecision::cpp_int;
  using IVec = std::array<Int, 3>;
  struct Triangle {
    std::uint32_t instance, primitive;
    std::array<Vec3, 3> model;
    std::array<DVec3, 3> world;  // rounded; for sizes, never for decisions
    DVec3 centre;
    double radius;
  };
  struct Frame {
    std::size_t first = 0;
    bool identity = true;
    DVec3 translation{0};
    DMat3 model_from_world{1};  // directions; rounded
    double condition = 1;
  };
  /// Exact signs: the ray's line against the three edges, and the plane.
  struct Sides {
    std::array<double, 3> volume;  // rounded values whose signs are exact; positive inside
    int facing;                    // sign of normal . direction
    bool inside;
  };

  static constexpr int kScale = 298;
  static Int integer(float x, int scale) {
    if (x == 0) return 0;
    int exponent;
    const double mantissa = std::frexp(static_cast<double>(x), &exponent);
    const auto bits = static_cast<std::int64_t>(std::ldexp(mantissa, 24));
    return Int(bits) << (exponent - 24 + scale);
  }
  static Int integer(double x) {  // truncated: offsets need no last bit
    if (x == 0) return 0;
    int exponent;
    const double mantissa = std::frexp(x, &exponent);
    const auto bits = static_cast<std::int64_t>(std::ldexp(mantissa, 53));
    const int shift = exponent - 53 + kScale;
    return shift >= 0 ? Int(Int(bits) << shift) : Int(bits >> std::min(63, -shift));
  }
  static IVec sub(const IVec& a, const IVec& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }
  static IVec cross(const IVec& a, const IVec& b) {
    return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  }
  static Int dot(const IVec& a, const IVec& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }
  /// Value divided by 2^bits, its sign kept exactly.
  static double scaled(const Int& x, int bits) {
    if (x == 0) return 0;
    const Int magnitude = boost::multiprecision::abs(x);
    const int top = static_cast<int>(boost::multiprecision::msb(magnitude)), drop = std::max(0, top - 62);
    const double value = std::ldexp(static_cast<double>(static_cast<std::uint64_t>(magnitude >> drop)), drop - bits);
    const double safe = value == 0 ? 1e-300 : value;
    return x < 0 ? -safe : safe;
  }
  static double norm(const DMat3& m) {
    double most = 0;
    for (int r = 0; r < 3; ++r) most = std::max(most, std::fabs(m[0][r]) + std::fabs(m[1][r]) + std::fabs(m[2][r]));
    return most;
  }
  static double largest(const DVec3& v) { return std::max({std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)}); }

  Sides exact(const Ray& ray, const Triangle& triangle, const DVec3& offset = DVec3(0)) const {
    const scene::Affine& m = placements_[triangle.instance];
    IVec o, d;
    for (int a = 0; a < 3; ++a) {
      o[static_cast<std::size_t>(a)] = integer(ray.origin[a], kScale) + integer(offset[a]);
      d[static_cast<std::size_t>(a)] = integer(ray.direction[a], kScale);
    }
    std::array<IVec, 3> p;
    for (std::size_t k = 0; k < 3; ++k) {
      for (int row = 0; row < 3; ++row) {
        Int x;
        if (frames_[triangle.instance].identity) {
          x = integer(triangle.model[k][row], kScale);
        } else {
          x = integer(m.translation[row], kScale);
          for (int c = 0; c < 3; ++c) x += integer(m.linear[c][row], 149) * integer(triangle.model[k][c], 149);
        }
        p[k][static_cast<std::size_t>(row)] = x - o[static_cast<std::size_t>(row)];
      }
    }
    std::array<Int, 3> volume;
    for (std::size_t k = 0; k < 3; ++k) volume[k] = dot(d, cross(p[(k + 1) % 3], p[(k + 2) % 3]));
    const IVec n = cross(sub(p[1], p[0]), sub(p[2], p[0]));
    const Int facing = dot(n, d);
    Sides out{};
    out.facing = facing > 0 ? 1 : facing < 0 ? -1 : 0;
    const int sign = out.facing == 0 ? 1 : out.facing;
    for (std::size_t k = 0; k < 3; ++k) out.volume[k] = sign * scaled(volume[k], 3 * kScale);
    out.inside = out.facing != 0 && out.volume[0] >= 0 && out.volume[1] >= 0 && out.volume[2] >= 0;
    return out;
  }

  // How far a rounded kernel may see the ray from where it is.
  double bound(const Triangle& t, const DVec3& o) const {
    double distance = 0;
    for (const DVec3& p : t.world) distance = std::max(distance, largest(p - o));
    double delta = 0x1p-20 * distance;
    const Frame& f = frames_[t.instance];
    if (!f.identity) delta += 0x1p-21 * f.condition * (largest(o - f.translation) + distance);
    return delta;
  }
  double plane_t(const Triangle& t, const DVec3& o, const DVec3& d) const {
    const DVec3 n = glm::cross(t.world[1] - t.world[0], t.world[2] - t.world[0]);
    const double facing = glm::dot(n, d);
    const auto [lo, hi] = t_range(t, o, d);
    return facing == 0 ? lo : std::clamp(glm::dot(n, t.world[0] - o) / facing, lo, hi);
  }
  std::pair<double, double> t_range(const Triangle& t, const DVec3& o, const DVec3& d) const {
    double lo = 1e300, hi = -1e300;
    for (const DVec3& p : t.world) {
      const double x = glm::dot(p - o, d) / glm::dot(d, d);
      lo = std::min(lo, x);
      hi = std::max(hi, x);
    }
    return {lo, hi};
  }
  // Moving the vertices by delta changes t hardly at all for a broad triangle; the t of one that looks
  // thinner than delta t may lie anywhere along it. The kernel's rounding moves them otherwise for each edge, so the
  // mean of the corners that it takes need not lie on the ray: its t is that mean's depth along the direction's
  // largest component (Woop, Benthin, Wald 2013), where the corners may lie farther apart than along the ray.
  double t_slack(const Triangle& t, const DVec3& o, const DVec3& d, double delta) const {
    const DVec3 e1 = t.world[1] - t.world[0], e2 = t.world[2] - t.world[0];
    const double facing = std::fabs(glm::dot(glm::cross(e1, e2), d));  // twice the area seen, times |d|
    const double longest =
        std::max({glm::length(glm::cross(d, e1)), glm::length(glm::cross(d, e2)), glm::length(glm::cross(d, e2 - e1))});
    const double thin = facing > 0 ? std::min(1.0, 4 * delta * longest / facing) : 1.0;
    const DMat3& to_model = frames_[t.instance].model_from_world;
    const DVec3 along = to_model * d, a = to_model * e1, b = to_model * e2, size = glm::abs(along);
    const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
    const double deep = (std::max({0.0, a[axis], b[axis]}) - std::min({0.0, a[axis], b[axis]})) / size[axis];
    const auto [lo, hi] = t_range(t, o, d);
    return thin * std::max(deep, hi - lo) + 2 * delta / glm::length(d) + 0x1p-20 * std::fabs(hi);
  }
  // No factor on delta: a volume over |d x edge| is the distance between the ray's line and the edge's, and delta is
  // already the most that rounding moves one against the other (about 5 u of the 16 u are the kernel's own).
  bool near_triangle(const Sides& s, const Triangle& t, const DVec3& d, double delta) const {
    for (std::size_t k = 0; k < 3; ++k) {
      const DVec3 edge = t.world[(k + 2) % 3] - t.world[(k + 1) % 3];
      const double side = s.facing == 0 ? -std::fabs(s.volume[k]) : s.volume[k];
      if (side < -delta * glm::length(glm::cross(d, edge))) return false;
    }
    return true;
  }
  bool blocks(const Sides& s, const Triangle& t, const DVec3& o, const DVec3& d, double limit) const {
    if (!s.inside) return false;
    const double slack = t_slack(t, o, d, bound(t, o)), at = plane_t(t, o, d);
    return at > slack && at < limit - slack;
  }
  // Everything that the ray or a ray within a generous bound may meet before `limit`.
  std::vector<const Triangle*> near_line(const DVec3& o, const DVec3& d, double limit) const {
    std::vector<const Triangle*> out;
    const DVec3 along = d / glm::length(d);
    for (const Triangle& t : triangles_) {
      const DVec3 to = t.centre - o;
      const double far = 1.001 * t.radius + 1e-4 * largest(to), depth = glm::dot(to, along);
      if (glm::dot(to, to) - depth * depth > far * far) continue;
      const DVec3 p[3] = {t.world[0] - o, t.world[1] - o, t.world[2] - o};
      double volume[3], reach[3];
      for (int k = 0; k < 3; ++k) {
        volume[k] = glm::dot(d, glm::cross(p[(k + 1) % 3], p[(k + 2) % 3]));
        reach[k] = 64 * bound(t, o) * glm::length(glm::cross(d, p[(k + 2) % 3] - p[(k + 1) % 3]));
      }
      bool positive = true, negative = true;
      for (int k = 0; k < 3; ++k) positive &= volume[k] > -reach[k], negative &= volume[k] < reach[k];
      if (!positive && !negative) continue;
      const auto [lo, hi] = t_range(t, o, d);
      if (hi > 0 && lo < limit) out.push_back(&t);
    }
    return out;
  }

  std::vector<Triangle> triangles_;
  std::vector<Frame> frames_;
  std::vector<scene::Affine> placements_;
};

}  // namespace carousel::accel
