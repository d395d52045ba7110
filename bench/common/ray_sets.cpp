#include "bench/common/ray_sets.h"

#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

#include "accel/traverse/reference_tracer.h"
#include "core/numeric/rng.h"
#include "shading/camera/camera_rays.h"
#include "shading/camera/pixel_order.h"
#include "shading/surface/spawn_point.h"
#include "shading/surface/triangle_geometry.h"

namespace carousel::bench {

void RaySet::push_back(const Ray& ray) {
  if (batches.empty() || batches.back().size() == kBatchRays) batches.emplace_back().reserve(kBatchRays);
  RayRequest request;
  request.ray = ray;
  request.tag.path = static_cast<std::uint32_t>(size++);
  request.tag.kind = any_hit ? RayKind::kShadow : RayKind::kBounce;
  batches.back().push_back(request);
}

namespace {

/// The point where a primary ray met a surface, on the side it came from.
struct SurfacePoint {
  Vec3 position;
  Vec3 normal;  ///< unit
};

RaySet primary_rays(const scene::Scene& scene, std::uint32_t side) {
  RaySet set{.name = "primary", .coherent = true};
  const shading::CameraRays camera(scene.cameras.at(0), CameraConfig{}, side, side);
  const shading::PixelOrder order(side, side, 1);
  for (std::uint64_t i = 0; i < order.count(); ++i) {
    const shading::PixelSample pixel = order.at(i);
    set.push_back(camera.ray(pixel.x, pixel.y, {{0.5f, 0.5f}, {0.5f, 0.5f}}));
  }
  return set;
}

std::vector<SurfacePoint> surface_points(const scene::Scene& scene, const accel::Accel& accel, const RaySet& rays) {
  std::vector<SurfacePoint> points;
  HitBatch hits;
  IntersectionCounts counts;
  for (const RayBatch& batch : rays.batches) {
    hits.clear();
    accel::trace_depth_first(accel, batch, hits, counts);
    for (const RayResult& result : hits) {
      if (!result.hit.valid()) continue;
      const shading::TriangleGeometry geometry =
          shading::triangle_geometry(scene, result.hit.instance, result.hit.primitive, result.hit.u, result.hit.v);
      const bool front = glm::dot(geometry.normal, DVec3(result.ray.direction)) < 0;
      points.push_back(
          {shading::spawn_point(geometry, front ? shading::Side::kFront : shading::Side::kBack, SpawnOffset::kBound),
           Vec3(front ? geometry.normal : -geometry.normal)});
    }
  }
  return points;
}

/// A point of the scene's first light, or straight up at the top of a scene without lights.
Ray shadow_ray(const scene::Scene& scene, const Aabb& bounds, const SurfacePoint& point) {
  Ray ray;
  ray.origin = point.position;
  if (!scene.lights.empty() && scene.lights[0].kind == scene::PunctualLight::Kind::kDirectional) {
    ray.direction = -scene.lights[0].direction;
    return ray;
  }
  const Vec3 light =
      scene.lights.empty() ? Vec3{bounds.centre().x, bounds.hi.y, bounds.centre().z} : scene.lights[0].position;
  ray.direction = light - point.position;
  ray.tmax = 1;
  if (glm::dot(ray.direction, ray.direction) == 0) ray.direction = point.normal;
  return ray;
}

Ray cosine_ray(const SurfacePoint& point, std::uint64_t seed, std::uint32_t index) {
  const PhiloxCounter random = random_block({.seed = seed, .pixel = index}, 0);
  const float z = 1 - 2 * unit_float(random[0]);
  const float angle = 2 * std::numbers::pi_v<float> * unit_float(random[1]);
  const float radius = std::sqrt(std::max(0.0f, 1 - z * z));
  const Vec3 sum = point.normal + Vec3{radius * std::cos(angle), radius * std::sin(angle), z};
  const float length = std::sqrt(glm::dot(sum, sum));
  Ray ray;
  ray.origin = point.position;
  ray.direction = length > 1e-4f ? sum / length : point.normal;
  return ray;
}

// Fisher and Yates; std::shuffle gives another order with another library.
std::vector<std::uint32_t> random_order(std::size_t count, std::uint64_t seed) {
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0u);
  for (std::size_t i = count; i > 1; --i) {
    const std::uint32_t word = random_block({.seed = seed, .pixel = static_cast<std::uint32_t>(i)}, 1)[0];
    std::swap(order[i - 1], order[static_cast<std::size_t>((std::uint64_t{word} * i) >> 32)]);
  }
  return order;
}

}  // namespace

std::vector<RaySet> make_ray_sets(const scene::Scene& scene, const accel::Accel& accel, std::uint32_t image_side,
                                  std::uint64_t seed) {
  RaySet primary = primary_rays(scene, image_side);
  const std::vector<SurfacePoint> points = surface_points(scene, accel, primary);
  const Aabb bounds = scene.bounds();
  RaySet shadow{.name = "shadow", .any_hit = true, .coherent = true};
  RaySet bounce{.name = "bounce"}, shuffled{.name = "shuffled"};
  RaySet shuffled_any{.name = "shuffled-any", .any_hit = true};
  for (std::size_t i = 0; i < points.size(); ++i) {
    shadow.push_back(shadow_ray(scene, bounds, points[i]));
    bounce.push_back(cosine_ray(points[i], seed, static_cast<std::uint32_t>(i)));
  }
  for (const std::uint32_t i : random_order(points.size(), seed)) {
    shuffled.push_back(bounce[i].ray);
    shuffled_any.push_back(bounce[i].ray);
  }
  std::vector<RaySet> sets;
  for (RaySet* set : {&primary, &shadow, &bounce, &shuffled, &shuffled_any}) sets.push_back(std::move(*set));
  return sets;
}

HitList reference_hits(const accel::Accel& accel, const RaySet& rays) {
  HitList hits;
  hits.reserve(rays.size);
  HitBatch found;
  IntersectionCounts counts;
  for (const RayBatch& batch : rays.batches) {
    found.clear();
    accel::trace_depth_first(accel, batch, found, counts);
    for (const RayResult& result : found) hits.push_back(result.hit);
  }
  return hits;
}

}  // namespace carousel::bench
