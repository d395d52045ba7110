// The way of light through thin, smooth walls (surface/pane.h): straight on, for shadow rays as for paths, so that the
// light behind a window is sampled from the surfaces that it falls on.
#include <algorithm>
#include <cmath>

#include <glm/geometric.hpp>

#include "shading/surface/alpha_test.h"
#include "shading/tracer/path_tracer-inl.h"

namespace carousel::shading {

namespace {

constexpr float kCertain = 1e30f;      // density of a direction that no light is sampled for: the camera's
constexpr std::uint32_t kTurn = 0x51;  // tells the choice at a pane from a blended surface's

}  // namespace

bool PathTracer::pass_pane(const RayResult& result, const TriangleGeometry& geometry, bool front,
                           const InterfacePoint& pane, float cosine, Worker& worker, RayBatch& out,
                           std::uint32_t& children) {
  PathState& path = pool_.state(result.tag.path);
  const Vec3 passing = passing_share(pane, cosine);
  const float chance = passing_chance(pane, passing, cosine);
  if (blend_chance(result.ray, result.hit.instance, result.hit.primitive ^ kTurn) >= chance) {
    path.throughput *= 1.0f / (1.0f - chance);
    return false;
  }
  const std::uint32_t bounce = result.tag.bounce;
  if (bounce + 1 >= max_depth_) return true;
  Vec3 throughput = path.throughput * passing * (1.0f / chance);
  if (bounce >= detail::kRouletteFrom) {
    const float survival = std::clamp(max_component(throughput), detail::kLeastSurvival, detail::kMostSurvival);
    if (sampler_.light(path.pixel, path.sample, bounce).roulette >= survival) return true;
    throughput *= 1.0f / survival;
  }
  if (!(max_component(throughput) > 0.0f)) return true;
  path.throughput = throughput;
  if (result.tag.kind == RayKind::kCamera) path.bounce_pdf = kCertain;
  path.behind += result.hit.t;
  const Vec3 start = spawn_point(geometry, front ? Side::kBack : Side::kFront, spawn_);
  emit({start, 0.0f, result.ray.direction, kInfinity},
       {result.tag.path, RayKind::kBounce, static_cast<std::uint8_t>(bounce + 1), 0, 0}, worker, out);
  ++children;
  return true;
}

void PathTracer::pass_shadow(const RayResult& result, Worker& worker, RayBatch& out, std::uint32_t& children) {
  const Hit& hit = result.hit;
  RayTag tag{result.tag.path, RayKind::kShadow, result.tag.bounce, static_cast<std::uint8_t>(result.tag.index + 1), 0};
  // As far as a path of bounce rays would come, with which the light is shared.
  if (tag.bounce + tag.index + 2u > max_depth_) return;
  const TrianglePoint point = triangle_point(scene_, hit.instance, hit.primitive, hit.u, hit.v);
  const Surface& own = surfaces_[static_cast<std::size_t>(point.material - scene_.materials.data())];
  if (!own.pane) return;
  const TriangleGeometry geometry = hit_geometry(scene_, result.ray, hit);
  const Vec3 wo = -glm::normalize(result.ray.direction);
  const bool front = glm::dot(geometry.normal, DVec3(wo)) >= 0.0;
  const Vec3 facing = Vec3(front ? geometry.normal : -geometry.normal);
  const float cosine = glm::dot(shading_normal(scene_, point, geometry, facing, front, wo), wo);
  MaterialPoint material = material_point(scene_, point);
  material.roughness = widened_roughness(material.roughness);  // as on the path of a bounce ray from there
  const InterfacePoint pane =
      interface_point({scene_, point, geometry, facing, wo, front, true}, material, own.glass, cosine);
  Vec3& contribution = pool_.shadow_contribution(tag.path, tag.bounce);
  contribution *= passing_share(pane, cosine);
  if (max_component(contribution) < 0x1p-29f) return;
  const Vec3 start = spawn_point(geometry, front ? Side::kBack : Side::kFront, spawn_);
  Vec3 direction = result.ray.direction;
  if (result.ray.tmax < kInfinity) direction += result.ray.origin - start;
  emit({start, 0.0f, direction, result.ray.tmax}, tag, worker, out);
  ++children;
}

}  // namespace carousel::shading
