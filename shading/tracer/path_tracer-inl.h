#pragma once

// The templates of PathTracer, one instance for each set of effects. path_tracer.cpp chooses among them.

#include <algorithm>
#include <cmath>
#include <type_traits>

#include <glm/geometric.hpp>

#include "shading/math/luminance.h"
#include "shading/math/shading_basis.h"
#include "shading/surface/material_properties.h"
#include "shading/surface/pane.h"
#include "shading/surface/spawn_point.h"
#include "shading/tracer/path_tracer.h"

namespace carousel::shading {

namespace detail {

inline constexpr std::uint32_t kRouletteFrom = 3;  // bounce of the first surface at which a path may be ended early
inline constexpr float kMostSurvival = 0.95f, kLeastSurvival = 0.05f;

inline float balance(float own, float other) {
  return own / (own + other);
}

constexpr bool has_textures(SurfaceClass c) {
  return c != SurfaceClass::kPlain;
}
constexpr bool transmits(SurfaceClass c) {
  return c == SurfaceClass::kTransmissive || c == SurfaceClass::kLayeredTransmissive || c == SurfaceClass::kAnything;
}
constexpr bool layered(SurfaceClass c) {
  return c == SurfaceClass::kLayered || c == SurfaceClass::kLayeredOpaque || c == SurfaceClass::kLayeredTransmissive ||
         c == SurfaceClass::kAnything;
}
constexpr bool has_boundary(SurfaceClass c) {
  return transmits(c) || c == SurfaceClass::kOpaque || c == SurfaceClass::kLayeredOpaque;
}

}  // namespace detail

/// State of one shader worker, on cache lines of its own.
struct alignas(128) PathTracer::Worker {
  HitsDigest digest;
  Counts counts;
  std::vector<std::uint32_t> states;  // scratch: states admitted, or states to release
  std::vector<std::uint32_t> begun;   // scratch: admitted states whose first hits are known
  RayBatch held;                      // rays for which no generate() call has had room
};

template <bool kMedia, class ShadeHit>
void PathTracer::shade_batch(WorkerId worker_id, const HitBatch& completed, RayBatch& out, const ShadeHit& shade_hit) {
  Worker& worker = workers_[worker_id.value];
  worker.states.clear();
  constexpr std::size_t kAhead = 4;  // rays complete in no order: their path states are rarely in the cache
  for (std::size_t i = 0; i < completed.size(); ++i) {
    if (i + kAhead < completed.size()) __builtin_prefetch(&pool_.state(completed[i + kAhead].tag.path), 1);
    const RayResult& result = completed[i];
    const PathState& path = pool_.state(result.tag.path);
    ++worker.counts.completed[static_cast<std::size_t>(result.tag.kind)];
    worker.digest.add(hit_term(path.pixel, path.sample, result.tag, result.hit));
    if (recorder_ != nullptr) recorder_->record(worker_id, path.pixel, path.sample, result);
    std::uint32_t children = 0;
    if (result.tag.kind == RayKind::kShadow) {
      shade_shadow(result, worker, out, children);
    } else if (!scene_.gaussians.empty()) {
      shade_gaussians(result, worker);
    } else if (!result.hit.valid()) {
      shade_miss(result, worker);
    } else {
      if constexpr (kMedia) absorb(result);
      const Hit& hit = result.hit;
      shade_hit(result, triangle_point(scene_, hit.instance, hit.primitive, hit.u, hit.v), worker, out, children);
    }
    finish_ray(result.tag.path, children, worker);
  }
  pool_.release(worker.states);
}

template <SurfaceClass kClass, PathTracer::Lights kLights>
void PathTracer::shade_surface(const RayResult& result, const TrianglePoint& point, Worker& worker, RayBatch& out,
                               std::uint32_t& children) {
  const Hit& hit = result.hit;
  PathState& path = pool_.state(result.tag.path);
  if (kClass == SurfaceClass::kUnlit || (kClass == SurfaceClass::kAnything && point.material->unlit)) {
    add_radiance(path, path.throughput * base_color(scene_, point), worker);
    return;
  }
  if constexpr (kClass != SurfaceClass::kUnlit) {
    const TriangleGeometry geometry = hit_geometry(scene_, result.ray, hit);
    const Vec3 wo = -result.ray.direction;
    const bool front = glm::dot(geometry.normal, DVec3(wo)) >= 0.0;
    if constexpr (kLights >= Lights::kEmissive) {
      if (is_emissive(*point.material)) add_emission(path, result, geometry, point, front, worker);
    }
    if (result.tag.bounce + 1u >= max_depth_ && (kLights == Lights::kNone || lights_.empty())) return;
    const Vec3 facing = Vec3(front ? geometry.normal : -geometry.normal);
    const Vec3 normal = detail::has_textures(kClass)
                            ? shading_normal(scene_, point, geometry, facing, front, wo)
                            : shading_normal(scene_, point, geometry, facing, front, wo, nullptr, 1.0f);
    MaterialPoint material =
        detail::has_textures(kClass) ? material_point(scene_, point) : material_factors(*point.material);
    if (path.scattered) material.roughness = widened_roughness(material.roughness);

    if constexpr (kClass == SurfaceClass::kPlain || kClass == SurfaceClass::kTextured) {
      const ShadingBasis frame(normal);
      scatter<kClass, kLights>(result, point, geometry, facing, front, frame, Bsdf(material, frame.to_local(wo)),
                               worker, out, children);
    } else {
      const SurfaceHit surface{scene_, point, geometry, facing, wo, front, path.scattered};
      const Surface& own = surfaces_[static_cast<std::size_t>(point.material - scene_.materials.data())];
      const ShadingBasis frame = detail::has_boundary(kClass) ? grain_frame(surface, normal) : ShadingBasis(normal);
      const Vec3 local = frame.to_local(wo);
      const auto shade_base = [&](const auto& base) {
        using Base = std::remove_cvref_t<decltype(base)>;
        if constexpr (detail::layered(kClass)) {
          const LayeredBsdf<Base> bsdf(layer_point(surface, frame, own.glass), base, local);
          scatter<kClass, kLights>(result, point, geometry, facing, front, frame, bsdf, worker, out, children);
        } else {
          scatter<kClass, kLights>(result, point, geometry, facing, front, frame, base, worker, out, children);
        }
      };
      if constexpr (!detail::has_boundary(kClass)) {
        shade_base(Bsdf(material, local));
      } else if (kClass == SurfaceClass::kAnything && !own.boundary) {
        shade_base(Bsdf(material, local));
      } else {
        const InterfacePoint boundary = interface_point(surface, material, own.glass, local.z);
        if constexpr (detail::transmits(kClass)) {
          if (own.pane) {
            if (pass_pane(result, geometry, front, boundary, local.z, worker, out, children)) return;
            scatter<SurfaceClass::kOpaque, kLights>(result, point, geometry, facing, front, frame,
                                                    InterfaceBsdf<false>(boundary, local), worker, out, children);
            return;
          }
        }
        shade_base(InterfaceBsdf<detail::transmits(kClass)>(boundary, local));
      }
    }
  }
}

/// The shadow ray and the bounce ray of a surface.
template <SurfaceClass kClass, PathTracer::Lights kLights, class SomeBsdf>
void PathTracer::scatter(const RayResult& result, const TrianglePoint& point, const TriangleGeometry& geometry,
                         const Vec3& facing, bool front, const ShadingBasis& frame, const SomeBsdf& bsdf,
                         Worker& worker, RayBatch& out, std::uint32_t& children) {
  constexpr bool kThrough = detail::transmits(kClass), kMedia = kLights == Lights::kEmissiveAndMedia;
  PathState& path = pool_.state(result.tag.path);
  const std::uint32_t bounce = result.tag.bounce;
  const bool last = bounce + 1 >= max_depth_;
  const Vec3 origin = spawn_point(geometry, front ? Side::kFront : Side::kBack, spawn_);
  const LightDraw light_draw = sampler_.light(path.pixel, path.sample, bounce);
  RayTag tag{result.tag.path, RayKind::kShadow, result.tag.bounce, 0, 0};

  // The volumes that a ray is in that goes on from the surface.
  const auto volumes_beyond = [&](bool through) {
    VolumeStack volumes = pool_.volumes(tag.path);
    if (!through || !has_volume(*point.material)) return volumes;
    const auto material = static_cast<std::uint32_t>(point.material - scene_.materials.data());
    front ? volumes.enter(material) : volumes.leave(material);
    return volumes;
  };

  if constexpr (kLights != Lights::kNone) {
    if (!lights_.empty()) {
      LightSample light = lights_.sample(light_draw, origin, spawn_);
      const float side = glm::dot(facing, light.wi);
      if (max_component(light.radiance) > 0.0f && (side > 0.0f || (kThrough && side < 0.0f))) {
        const Vec3 wi = frame.to_local(light.wi);
        const BsdfValue value = wi.z * side > 0.0f || !kThrough ? bsdf.evaluate(wi) : BsdfValue{};
        // The last surface has no bounce ray to share the light with; punctual lights never do.
        const float weight = last || light.pdf == 0.0f ? 1.0f : detail::balance(light.pdf, value.pdf);
        Vec3 contribution = path.throughput * value.f_cos * light.radiance * weight;
        Vec3 start = origin;
        if constexpr (kThrough) {
          if (side < 0.0f) {
            start = spawn_point(geometry, front ? Side::kBack : Side::kFront, spawn_);
            if (light.tmax < kInfinity) light.direction += origin - start;
          }
        }
        if constexpr (kMedia) {
          const std::uint32_t medium = volumes_beyond(side < 0.0f).innermost();
          if (medium != 0) contribution *= passed(medium, light.tmax < kInfinity ? glm::length(light.direction) : 0.0f);
        }
        // A contribution below half a step of the film's fixed point adds exactly nothing and needs no ray. NaN passes
        // the comparison and is counted later.
        if (!(max_component(contribution) < 0x1p-29f)) {
          pool_.shadow_contribution(tag.path, bounce) = contribution;
          emit({start, 0.0f, light.direction, light.tmax}, tag, worker, out);
          ++children;
        }
      }
    }
  }
  if (last) return;

  const DirectionDraw draw = sampler_.direction(path.pixel, path.sample, bounce);
  const Vec3 wi_local = bsdf.sample(draw.lobe, draw.direction);
  const BsdfValue value = bsdf.evaluate(wi_local);
  const Vec3 wi = glm::normalize(frame.to_world(wi_local));
  const bool through = kThrough && wi_local.z < 0.0f;
  const float side = glm::dot(facing, wi);
  if (!(value.pdf > 0.0f) || !((through ? -side : side) > 0.0f)) return;
  Vec3 throughput = path.throughput * value.f_cos * (1.0f / value.pdf);
  if (bounce >= detail::kRouletteFrom) {
    const float survival = std::clamp(max_component(throughput), detail::kLeastSurvival, detail::kMostSurvival);
    if (light_draw.roulette >= survival) return;
    throughput *= 1.0f / survival;
  }
  if (!(max_component(throughput) > 0.0f)) return;
  path.throughput = throughput;
  path.bounce_pdf = value.pdf;
  path.behind = 0;
  const bool wide = bsdf.is_wide(draw.lobe);
  path.scattered = path.scattered || wide;
  if (wide) tag.flags = kRayAlone;
  if constexpr (kMedia) pool_.volumes(tag.path) = volumes_beyond(through);
  tag.kind = RayKind::kBounce;
  ++tag.bounce;
  const Vec3 start = through ? spawn_point(geometry, front ? Side::kBack : Side::kFront, spawn_) : origin;
  emit({start, 0.0f, wi, kInfinity}, tag, worker, out);
  ++children;
}

}  // namespace carousel::shading
