#include "shading/path_tracer.h"

#include <algorithm>
#include <cmath>
#include <span>

#include <glm/geometric.hpp>

#include "core/fixed_point.h"
#include "shading/frame.h"
#include "shading/luminance.h"
#include "shading/sky.h"
#include "shading/spawn_point.h"

namespace carousel::shading {

namespace {

constexpr std::uint32_t kRouletteFrom = 3;  // bounce of the first surface at which a path may be ended early
constexpr float kMostSurvival = 0.95f, kLeastSurvival = 0.05f;

std::uint32_t u32(std::int64_t v) {
  return static_cast<std::uint32_t>(v);
}

std::uint8_t flags_of(const RayWishes& wishes) {
  const int cull = wishes.cull == RayWishes::Cull::kBack ? kRayCullBack : wishes.cull == RayWishes::Cull::kFront ? kRayCullFront : 0;
  return static_cast<std::uint8_t>(cull | (wishes.force_opaque ? kRayForceOpaque : 0));
}

float balance(float own, float other) {
  return own / (own + other);
}

}  // namespace

/// What one shader worker keeps to itself, on cache lines of its own.
struct alignas(128) PathTracer::Worker {
  HitsDigest digest;
  Counts counts;
  std::vector<std::uint32_t> states;  // scratch: admitted, or to be released
  std::vector<std::uint32_t> begun;   // scratch: admitted, where first hits are known
  RayBatch held;                      // rays that no generate() has had room for
};

PathTracer::PathTracer(const scene::Scene& scene, const Config& config, std::size_t max_paths_in_flight,
                       std::size_t workers)
    : scene_(scene),
      paths_(static_cast<std::uint64_t>(config.image.width) *
             static_cast<std::uint64_t>(config.image.height) *
             static_cast<std::uint64_t>(config.image.samples)),
      max_depth_(u32(config.image.max_depth)),
      spawn_(config.accuracy.spawn),
      wishes_{flags_of(config.shading.camera_rays), flags_of(config.shading.bounce_rays), flags_of(config.shading.shadow_rays)},
      sampler_(static_cast<std::uint64_t>(config.image.seed), u32(config.image.samples)),
      order_(u32(config.image.width), u32(config.image.height), u32(config.image.samples)),
      camera_(scene.cameras.at(static_cast<std::size_t>(config.scene.camera)), config.camera,
              u32(config.image.width), u32(config.image.height)),
      lights_(scene),
      pool_(max_paths_in_flight, paths_, max_depth_),
      film_(u32(config.image.width), u32(config.image.height), u32(config.image.samples)),
      workers_(std::make_unique<Worker[]>(workers)),
      worker_count_(workers) {}

PathTracer::~PathTracer() = default;

PixelSample PathTracer::begin_path(std::uint64_t ordinal, std::uint32_t index) {
  const PixelSample at = order_.at(ordinal);
  PathState& path = pool_.state(index);
  // Relaxed and plain: nobody else knows of this path until the engine has handed its ray over.
  for (auto& channel : path.radiance) channel.store(0, std::memory_order_relaxed);
  path.outstanding.store(1, std::memory_order_relaxed);
  path.pixel = at.y * film_.width() + at.x;
  path.sample = at.sample;
  path.throughput = Vec3{1};
  path.bounce_pdf = 0;
  path.scattered = false;
  return at;
}

Workload::Generated PathTracer::generate(WorkerId worker_id, std::size_t max_rays, RayBatch& out) {
  if (first_hits_ != nullptr) return generate_from_hits(worker_id, max_rays, out);
  Worker& worker = workers_[worker_id.value];
  worker.states.clear();
  const PathPool::Admission admitted = pool_.admit(max_rays, worker.states);
  for (std::size_t i = 0; i < admitted.count; ++i) {
    const PixelSample at = begin_path(admitted.first + i, worker.states[i]);
    const PathState& path = pool_.state(worker.states[i]);
    emit(camera_.ray(at.x, at.y, sampler_.camera(path.pixel, path.sample)),
         {worker.states[i], RayKind::kCamera, 0, 0, 0}, worker, out);
  }
  // Counted after appending, so that whoever reads the full count knows that no other call is still at it.
  // Acquire and release pair with the same operation of the other workers' calls.
  const std::uint64_t before = generated_.fetch_add(admitted.count, std::memory_order_acq_rel);
  return {admitted.count, before + admitted.count == paths_};
}

Workload::Generated PathTracer::generate_from_hits(WorkerId worker_id, std::size_t max_rays, RayBatch& out) {
  Worker& worker = workers_[worker_id.value];
  const std::size_t end = out.size() + max_rays;
  while (!worker.held.empty() && out.size() < end) {
    out.push_back(worker.held.back());
    worker.held.pop_back();
    // Acquire and release, as below: who reads 0 knows that this ray is in its batch.
    held_.fetch_sub(1, std::memory_order_acq_rel);
  }
  std::size_t made = 0;
  const std::size_t before = out.size();
  std::uint64_t started = generated_.load(std::memory_order_acquire);
  do {
    // A first hit sends two rays at most; an odd one is held back.
    worker.begun.clear();
    worker.states.clear();
    const PathPool::Admission admitted = pool_.admit((end - out.size() + 1) / 2, worker.begun);
    made = admitted.count;
    for (std::size_t i = 0; i < made; ++i) {
      const std::uint32_t index = worker.begun[i];
      const PixelSample at = begin_path(admitted.first + i, index);
      const PathState& path = pool_.state(index);
      const Ray ray = camera_.ray(at.x, at.y, sampler_.camera(path.pixel, path.sample));
      const RayTag tag{index, RayKind::kCamera, 0, 0, 0};
      if (const Hit* hit = first_hits_->at(path.pixel, path.sample)) {
        std::uint32_t children = 0;
        shade_closest({ray, *hit, tag}, worker, out, children);
        finish_ray(index, children, worker);
      } else {
        emit(ray, tag, worker, out);
      }
    }
    pool_.release(worker.states);
    while (out.size() > end) {
      worker.held.push_back(out.back());
      out.pop_back();
      held_.fetch_add(1, std::memory_order_acq_rel);
    }
    // After rays are held: who reads the full count here reads theirs too.
    started = generated_.fetch_add(made, std::memory_order_acq_rel) + made;
    // Paths that end where they begin make no ray; the engine would wait for one to come back.
  } while (made > 0 && out.size() == before && out.size() < end);
  return {out.size() - (end - max_rays), started == paths_ && held_.load(std::memory_order_acquire) == 0};
}

void PathTracer::shade(WorkerId worker_id, const HitBatch& completed, RayBatch& out) {
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
      shade_shadow(result, worker);
    } else {
      shade_closest(result, worker, out, children);
    }
    finish_ray(result.tag.path, children, worker);
  }
  pool_.release(worker.states);
}

void PathTracer::shade_shadow(const RayResult& result, Worker& worker) {
  if (result.hit.valid()) return;
  add_radiance(pool_.state(result.tag.path), pool_.shadow_contribution(result.tag.path, result.tag.bounce),
               worker);
}

void PathTracer::shade_closest(const RayResult& result, Worker& worker, RayBatch& out,
                               std::uint32_t& children) {
  PathState& path = pool_.state(result.tag.path);
  const Hit& hit = result.hit;
  if (!hit.valid()) {
    add_radiance(path, path.throughput * sky_radiance(scene_.sky, result.ray.direction), worker);
    return;
  }
  const TrianglePoint point = triangle_point(scene_, hit.instance, hit.primitive, hit.u, hit.v);
  if (point.material->unlit) {
    add_radiance(path, path.throughput * base_color(scene_, point), worker);
    return;
  }
  const TriangleGeometry geometry = triangle_geometry(scene_, hit.instance, hit.primitive, hit.u, hit.v);
  const Vec3 wo = -result.ray.direction;
  const bool front = glm::dot(geometry.normal, DVec3(wo)) >= 0.0;
  if (is_emissive(*point.material)) add_emission(path, result, geometry, point, front, worker);

  const std::uint32_t bounce = result.tag.bounce;
  const bool last = bounce + 1 >= max_depth_;
  if (last && lights_.empty()) return;
  const Vec3 facing = Vec3(front ? geometry.normal : -geometry.normal);
  const Frame frame(shading_normal(scene_, point, geometry, facing, front, wo));
  MaterialPoint material = material_point(scene_, point);
  if (path.scattered) material.roughness = widened_roughness(material.roughness);
  const Bsdf bsdf(material, frame.to_local(wo));
  const Vec3 origin = spawn_point(geometry, front ? Side::kFront : Side::kBack, spawn_);
  const LightDraw light_draw = sampler_.light(path.pixel, path.sample, bounce);
  RayTag tag{result.tag.path, RayKind::kShadow, result.tag.bounce, 0, 0};

  if (!lights_.empty()) {
    const LightSample light = lights_.sample(light_draw, origin, spawn_);
    if (max_component(light.radiance) > 0.0f && glm::dot(facing, light.wi) > 0.0f) {
      const BsdfValue value = bsdf.evaluate(frame.to_local(light.wi));
      // The last surface has no bounce ray to share the light with; punctual lights never do.
      const float weight = last || light.pdf == 0.0f ? 1.0f : balance(light.pdf, value.pdf);
      const Vec3 contribution = path.throughput * value.f_cos * light.radiance * weight;
      // Less than half a step of the film's fixed point adds exactly nothing: no ray. NaN passes, is counted.
      if (!(max_component(contribution) < 0x1p-29f)) {
        pool_.shadow_contribution(tag.path, bounce) = contribution;
        emit({origin, 0.0f, light.direction, light.tmax}, tag, worker, out);
        ++children;
      }
    }
  }
  if (last) return;

  const DirectionDraw draw = sampler_.direction(path.pixel, path.sample, bounce);
  const Vec3 wi_local = bsdf.sample(draw.lobe, draw.direction);
  const BsdfValue value = bsdf.evaluate(wi_local);
  const Vec3 wi = glm::normalize(frame.to_world(wi_local));
  if (!(value.pdf > 0.0f) || !(glm::dot(facing, wi) > 0.0f)) return;
  Vec3 throughput = path.throughput * value.f_cos * (1.0f / value.pdf);
  if (bounce >= kRouletteFrom) {
    const float survival = std::clamp(max_component(throughput), kLeastSurvival, kMostSurvival);
    if (light_draw.roulette >= survival) return;
    throughput *= 1.0f / survival;
  }
  if (!(max_component(throughput) > 0.0f)) return;
  path.throughput = throughput;
  path.bounce_pdf = value.pdf;
  path.scattered = path.scattered || bsdf.is_wide(draw.lobe);
  tag.kind = RayKind::kBounce;
  ++tag.bounce;
  emit({origin, 0.0f, wi, kInfinity}, tag, worker, out);
  ++children;
}

void PathTracer::add_emission(PathState& path, const RayResult& result, const TriangleGeometry& geometry,
                              const TrianglePoint& point, bool front, Worker& worker) {
  if (!emits(*point.material, front)) return;
  float weight = 1.0f;
  if (result.tag.kind == RayKind::kBounce) {
    const float cos_light = std::abs(glm::dot(Vec3(geometry.normal), result.ray.direction));
    weight = balance(path.bounce_pdf, lights_.triangle_pdf(result.hit.instance, result.hit.primitive,
                                                           result.hit.t, cos_light));
  }
  add_radiance(path, path.throughput * emitted(scene_, point) * weight, worker);
}

void PathTracer::add_radiance(PathState& path, const Vec3& radiance, Worker& worker) {
  for (int c = 0; c < 3; ++c) {
    const std::int64_t term = to_fixed_point(radiance[c], worker.counts.saturated);
    // Relaxed: finish_ray()'s decrement, which follows, publishes it to whoever commits the path.
    if (term != 0) path.radiance[c].fetch_add(term, std::memory_order_relaxed);
  }
}

void PathTracer::finish_ray(std::uint32_t index, std::uint32_t children, Worker& worker) {
  PathState& path = pool_.state(index);
  if (children == 1) return;  // the child takes its parent's place
  if (children > 1) {
    // Relaxed: the children's own decrements come after this, since the engine hands them over later.
    path.outstanding.fetch_add(children - 1, std::memory_order_relaxed);
    return;
  }
  // Release publishes this ray's radiance; acquire, in the last decrement, receives that of all the others.
  if (path.outstanding.fetch_sub(1, std::memory_order_acq_rel) != 1) return;
  std::int64_t sum[3];
  for (int c = 0; c < 3; ++c) {
    sum[c] = clamp_fixed_point(path.radiance[c].load(std::memory_order_relaxed), worker.counts.saturated);
  }
  film_.add(path.pixel, sum[0], sum[1], sum[2]);
  ++worker.counts.paths;
  worker.states.push_back(index);
}

void PathTracer::emit(const Ray& ray, const RayTag& tag, Worker& worker, RayBatch& out) {
  ++worker.counts.emitted[static_cast<std::size_t>(tag.kind)];
  RayTag wishing = tag;
  wishing.flags = wishes_[static_cast<std::size_t>(tag.kind)];
  out.push_back({ray, wishing});
}

PathTracer::Counts PathTracer::counts() const {
  Counts sum;
  for (const Worker& worker : std::span(workers_.get(), worker_count_)) {
    for (std::size_t k = 0; k < kRayKinds; ++k) {
      sum.emitted[k] += worker.counts.emitted[k];
      sum.completed[k] += worker.counts.completed[k];
    }
    sum.saturated += worker.counts.saturated;
    sum.paths += worker.counts.paths;
  }
  return sum;
}

HitsDigest PathTracer::hits_digest() const {
  HitsDigest sum;
  for (const Worker& worker : std::span(workers_.get(), worker_count_)) sum.add(worker.digest);
  return sum;
}

std::string PathTracer::image_digest() const {
  return carousel::image_digest(linear_rgb());
}

}  // namespace carousel::shading
