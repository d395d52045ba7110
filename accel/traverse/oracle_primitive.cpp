#include "accel/traverse/oracle_primitive.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "accel/exact/exact_triangle.h"
#include "accel/structure/program_hits.h"
#include "accel/structure/sphere.h"
#include "core/numeric/octahedral.h"

namespace carousel::accel {

namespace {

struct Crossing {
  float t, u, v;
};
using Corners = std::array<Vec3, 3>;

// Woop, Benthin, Wald 2013, appendix A, written from the paper for one triangle; T is the arithmetic.
template <class T>
struct Sheared {
  T x[3], y[3], z[3];  ///< corners seen from the origin along the ray; z times the shear is t
  T u, v, w;           ///< the edges' values

  Sheared(const Ray& ray, const Corners& p) {
    const Vec3 d = ray.direction;
    int kz = 0;
    if (std::fabs(d.y) >= std::fabs(d[kz])) kz = 1;
    if (std::fabs(d.z) >= std::fabs(d[kz])) kz = 2;
    int kx = (kz + 1) % 3, ky = (kx + 1) % 3;
    if (d[kz] < 0) std::swap(kx, ky);
    const T sx = T{d[kx]} / T{d[kz]}, sy = T{d[ky]} / T{d[kz]}, sz = T{1} / T{d[kz]};
    for (std::size_t i = 0; i < 3; ++i) {
      const T a[3] = {T{p[i].x} - ray.origin.x, T{p[i].y} - ray.origin.y, T{p[i].z} - ray.origin.z};
      x[i] = a[kx] - sx * a[kz];
      y[i] = a[ky] - sy * a[kz];
      z[i] = sz * a[kz];
    }
    u = x[2] * y[1] - y[2] * x[1];
    v = x[0] * y[2] - y[0] * x[2];
    w = x[1] * y[0] - y[1] * x[0];
  }

  T t_times_det() const { return u * z[0] + (v * z[1] + w * z[2]); }
};

template <class T>
bool signs_differ(T u, T v, T w) {
  return (u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0);
}

/// The edges' values of a triangle in float, from the exact products of its sheared corners. Where these are beyond
/// 2^-100 to 2^100 all three are scaled by one power of two. False if their signs differ.
bool settle_edges(Sheared<float>& s) {
  const auto &x = s.x, &y = s.y;
  double u = double(x[2]) * y[1] - double(y[2]) * x[1];
  double v = double(x[0]) * y[2] - double(y[0]) * x[2];
  double w = double(x[1]) * y[0] - double(y[1]) * x[0];
  if (signs_differ(u, v, w)) return false;
  const double most = std::max({std::fabs(u), std::fabs(v), std::fabs(w)});
  if (std::isfinite(most) && most > 0 && (most < 0x1p-100 || most > 0x1p100)) {
    const double scale = std::ldexp(1.0, -std::ilogb(most));
    u *= scale, v *= scale, w *= scale;
  }
  s.u = float(u), s.v = float(v), s.w = float(w);
  return true;
}

template <class T>
bool watertight_scalar(const Ray& ray, const Corners& p, Crossing& out) {
  Sheared<T> s(ray, p);
  if constexpr (std::is_same_v<T, float>) {
    if ((s.u == 0 || s.v == 0 || s.w == 0) && !settle_edges(s)) return false;
    if (signs_differ(s.u, s.v, s.w)) return false;
    const float size = std::fabs(s.u + (s.v + s.w));
    if (size != 0 && !(size >= 0x1p-100f && size <= 0x1p100f) && !settle_edges(s)) return false;
  }
  if (signs_differ(s.u, s.v, s.w)) return false;
  const T det = s.u + (s.v + s.w);
  if (det == 0 || std::isnan(det)) return false;
  const T inverse = T{1} / det;
  out = {float(s.t_times_det() * inverse), float(s.v * inverse), float(s.w * inverse)};
  return true;
}

// The distance and the weights in double of a triangle that the float meets.
void refine(const Ray& ray, const Corners& p, Crossing& out) {
  const Sheared<double> s(ray, p);
  const double det = s.u + (s.v + s.w), inverse = 1 / det;
  const bool ahead = out.t >= ray.tmin && out.t <= std::numeric_limits<float>::max();
  if (det != 0) {
    const auto [least, most] = std::minmax({s.z[0], s.z[1], s.z[2]});
    const double t = s.t_times_det() * inverse;
    double weight[3] = {s.u * inverse, s.v * inverse, s.w * inverse};
    if (weight[0] < 0 || weight[1] < 0 || weight[2] < 0) {
      for (double& part : weight) part = std::max(part, 0.0);
      const double sum = weight[0] + (weight[1] + weight[2]);
      for (double& part : weight) part /= sum;
    }
    out = {float(t < least ? least : t > most ? most : t), float(weight[1]), float(weight[2])};
  }
  if (ahead) out.t = std::clamp(out.t, ray.tmin, std::numeric_limits<float>::max());
}

// Möller, Trumbore 1997, section 2.
bool moller_trumbore_scalar(const Ray& ray, const Corners& p, Crossing& out) {
  const auto cross = [](const Vec3& a, const Vec3& b) {
    return Vec3{a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
  };
  const auto dot = [](const Vec3& a, const Vec3& b) { return a.x * b.x + (a.y * b.y + a.z * b.z); };
  const Vec3 e1 = p[1] - p[0], e2 = p[2] - p[0], across = cross(ray.direction, e2);
  const float inverse = 1.0f / dot(e1, across);
  const Vec3 s = ray.origin - p[0], q = cross(s, e1);
  out = {dot(e2, q) * inverse, dot(s, across) * inverse, dot(ray.direction, q) * inverse};
  return out.u >= 0 && out.v >= 0 && out.u + out.v <= 1;
}

bool crosses(TriangleLevel level, const Ray& ray, const Corners& p, Crossing& out) {
  switch (level) {
    case TriangleLevel::kFast:
      return moller_trumbore_scalar(ray, p, out);
    case TriangleLevel::kWatertight:
      if (!watertight_scalar<float>(ray, p, out)) return false;
      refine(ray, p, out);
      return true;
    case TriangleLevel::kDouble:
      return watertight_scalar<double>(ray, p, out);
    case TriangleLevel::kExact:
      break;
  }
  NearestCrossing crossing;
  if (!exact_triangle(ray, p, crossing)) return false;
  out = {crossing.t, crossing.u, crossing.v};
  return true;
}

/// 1 if the ray sees the side from which the corners run anticlockwise, -1 if it sees the other, 0 if neither. The
/// signed volume is exact in 113 bits but for corners of very different size.
int facing_of(const Ray& ray, const Corners& p) {
  __extension__ using Wide = __float128;
  const auto edge = [&](std::size_t k, int axis) { return Wide{p[k][axis]} - Wide{p[0][axis]}; };
  Wide sum = 0;
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    sum += Wide{ray.direction[i]} * (edge(1, j) * edge(2, k) - edge(1, k) * edge(2, j));
  }
  return sum < 0 ? 1 : sum > 0 ? -1 : 0;
}

Aabb box_of(const Corners& p) {
  Aabb box;
  for (const Vec3& v : p) box.extend(v);
  return box;
}

bool in_range(float t, const Ray& ray) {
  return t >= ray.tmin && t <= std::numeric_limits<float>::max();
}

}  // namespace

OraclePrimitives::OraclePrimitives(const scene::Scene& scene, const AccuracyConfig& accuracy, const AnyHit* any_hit)
    : scene_(scene), accuracy_(accuracy), any_hit_(any_hit), opacity_(scene) {
  placed_.reserve(scene.instances.size());
  for (const scene::Instance& instance : scene.instances) {
    Placed& placed = placed_.emplace_back();
    placed.mesh = &scene.meshes[instance.mesh.value];
    placed.placement = instance.world_from_model;
    placed.baked = !make_transform(instance.world_from_model, placed.transform, accuracy.transform);
    if (placed.baked) placed.transform = InstanceTransform{};
  }
}

std::uint32_t OraclePrimitives::primitives(std::uint32_t instance) const {
  const scene::Mesh& mesh = *placed_[instance].mesh;
  return static_cast<std::uint32_t>(mesh.triangle_count() + mesh.spheres.size());
}

OraclePrimitives::Corners OraclePrimitives::corners(const Placed& placed, std::uint32_t triangle) {
  Corners p;
  for (std::uint32_t k = 0; k < 3; ++k) {
    p[k] = placed.mesh->positions[placed.mesh->indices[3 * triangle + k]];
    if (placed.baked) p[k] = placed.placement.linear * p[k] + placed.placement.translation;
  }
  return p;
}

Aabb OraclePrimitives::box(std::uint32_t instance, std::uint32_t primitive) const {
  const Placed& placed = placed_[instance];
  const std::size_t triangles = placed.mesh->triangle_count();
  if (primitive < triangles) return box_of(corners(placed, primitive));
  const scene::Sphere& sphere = placed.mesh->spheres[primitive - triangles];
  return box_around(sphere.center, sphere.reach());
}

void OraclePrimitives::set_model_box(std::uint32_t instance, const Aabb& box) {
  Placed& placed = placed_[instance];
  placed.world = placed.baked ? box : accel::world_box(placed.placement, box, accuracy_.transform);
}

OraclePrimitives::LocalRay OraclePrimitives::local_ray(const Ray& world, std::uint32_t instance, float entry) const {
  const Ray ray = placed_[instance].transform.to_model(world);
  return {ray, OracleBoxTest(ray, accuracy_.box), instance, entry};
}

int OraclePrimitives::cross(const LocalRay& ray, std::uint32_t primitive, float tmax, Candidates& out) const {
  const Placed& placed = placed_[ray.instance];
  return primitive < placed.mesh->triangle_count() ? cross_triangle(ray, placed, primitive, tmax, out)
                                                   : cross_spheres(ray, placed, primitive, tmax, out);
}

int OraclePrimitives::cross_triangle(const LocalRay& ray, const Placed& placed, std::uint32_t primitive, float tmax,
                                     Candidates& out) const {
  const Corners p = corners(placed, primitive);
  float entry;
  Crossing crossing;
  if (!ray.boxes.enters(box_of(p), tmax, entry) || !crosses(accuracy_.triangle, ray.ray, p, crossing)) return 0;
  if (!in_range(crossing.t, ray.ray)) return 0;
  out[0] = {{std::max({crossing.t, entry, ray.entry}), crossing.u, crossing.v, ray.instance, primitive},
            facing_of(ray.ray, p)};
  return 1;
}

int OraclePrimitives::cross_spheres(const LocalRay& ray, const Placed& placed, std::uint32_t primitive, float tmax,
                                    Candidates& out) const {
  const scene::Sphere& sphere = placed.mesh->spheres[primitive - placed.mesh->triangle_count()];
  if (sphere.program != scene::kNoProgram) return cross_program(ray, sphere, primitive, tmax, out);
  SphereCrossing crossing;
  float entry;
  if (!cross_sphere(ray.ray.origin, ray.ray.direction, sphere.center, sphere.radius, crossing) ||
      !ray.boxes.enters(sphere_box(sphere.center, sphere.radius), tmax, entry))
    return 0;
  int count = 0;
  for (int k = 0; k < 2; ++k) {
    const float t = static_cast<float>(crossing.t[k]);
    const Vec2 uv = octahedral(crossing.normal[k]);
    if (in_range(t, ray.ray))
      out[static_cast<std::size_t>(count++)] = {{std::max({t, entry, ray.entry}), uv.x, uv.y, ray.instance, primitive},
                                                k == 0 ? 1 : -1};
  }
  return count;
}

int OraclePrimitives::cross_program(const LocalRay& ray, const scene::Sphere& bounds, std::uint32_t primitive,
                                    float tmax, Candidates& out) const {
  const Aabb box = box_around(bounds.center, bounds.reach());
  float entry;
  if (!ray.boxes.enters(box, tmax, entry)) return 0;
  const ProgramHits hits = program_hits(scene_.programs[bounds.program], box, ray.ray, nullptr);
  for (std::size_t k = 0; k < hits.count; ++k)
    out[k] = {{std::max({hits.hit[k].t, entry, ray.entry}), hits.hit[k].where.x, hits.hit[k].where.y, ray.instance,
               primitive},
              hits.hit[k].facing};
  return static_cast<int>(hits.count);
}

bool OraclePrimitives::accepts(const RayRequest& request, const Candidate& candidate) const {
  if ((request.tag.flags & kRayCullFront) != 0 && candidate.facing > 0) return false;
  if ((request.tag.flags & kRayCullBack) != 0 && candidate.facing < 0) return false;
  if (any_hit_ == nullptr || (request.tag.flags & kRayForceOpaque) != 0) return true;
  const Hit& hit = candidate.hit;
  const scene::Mesh& mesh = *placed_[hit.instance].mesh;
  const std::size_t triangles = mesh.triangle_count();
  const bool calls = hit.primitive < triangles ? opacity_.may_be_non_opaque(mesh, hit.primitive)
                                               : opacity_.may_be_non_opaque(mesh.spheres[hit.primitive - triangles]);
  return !calls || any_hit_->accepts(request.ray, hit.instance, hit.primitive, hit.u, hit.v);
}

}  // namespace carousel::accel
