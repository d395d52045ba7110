#include "shading/tracer/path_tracer.h"

#include <algorithm>
#include <cmath>
#include <span>

#include <glm/geometric.hpp>

#include "core/numeric/exponential.h"
#include "core/numeric/fixed_point.h"
#include "shading/tracer/path_tracer-inl.h"

namespace carousel::shading {

namespace {

std::uint32_t u32(std::int64_t v) {
  return static_cast<std::uint32_t>(v);
}

CameraConfig lens(CameraConfig camera, const EffectsPlan& plan) {
  if (!plan.on(Effect::kDepthOfField)) camera.aperture = 0;
  return camera;
}

/// With `effects: all` the effect is on without a pane, and shadow rays are to be those of other scenes.
bool has_panes(const EffectsPlan& plan) {
  const PlannedEffect& effect = plan.of(Effect::kTransparentShadows);
  return effect.on && effect.called_for;
}

std::uint8_t flags_of(const RayFlags& ray_flags) {
  const int cull = ray_flags.cull == RayFlags::Cull::kBack    ? kRayCullBack
                   : ray_flags.cull == RayFlags::Cull::kFront ? kRayCullFront
                                                              : 0;
  return static_cast<std::uint8_t>(cull | (ray_flags.force_opaque ? kRayForceOpaque : 0));
}

}  // namespace

PathTracer::PathTracer(const scene::Scene& scene, const Config& config, std::size_t max_paths_in_flight,
                       std::size_t workers)
    : scene_(scene),
      plan_(plan_effects(scene, config)),
      max_depth_(plan_.on(Effect::kBounceRays) ? u32(config.image.max_depth) : 1),
      spawn_(config.accuracy.spawn),
      ray_flags_{
          flags_of(config.shading.camera_rays), flags_of(config.shading.bounce_rays),
          static_cast<std::uint8_t>(flags_of(config.shading.shadow_rays) | (has_panes(plan_) ? kRayClosest : 0))},
      sampler_(static_cast<std::uint64_t>(config.image.seed), u32(config.image.samples)),
      paths_(PixelOrder(u32(config.image.width), u32(config.image.height), u32(config.image.samples))),
      camera_(scene.cameras.at(static_cast<std::size_t>(config.scene.camera)), lens(config.camera, plan_),
              u32(config.image.width), u32(config.image.height)),
      lights_(scene, plan_.on(Effect::kShadowRays), plan_.on(Effect::kShadowRays) && plan_.on(Effect::kAreaLights),
              plan_.on(Effect::kShadowRays)),
      media_(plan_.on(Effect::kVolume)),
      panes_(has_panes(plan_)),
      tables_(scene),
      pool_(max_paths_in_flight, paths_.count(), plan_.on(Effect::kShadowRays) ? max_depth_ : 0, media_),
      film_(u32(config.image.width), u32(config.image.height), u32(config.image.samples)),
      workers_(std::make_unique<Worker[]>(workers)),
      worker_count_(workers) {
  choose_surfaces();
}

PathTracer::~PathTracer() = default;

void PathTracer::set_sample(const PathSample* sample) {
  paths_.set_sample(sample);
  pool_.set_paths(paths_.count());
}

PixelSample PathTracer::begin_path(std::uint64_t ordinal, std::uint32_t index) {
  const PixelSample at = paths_.at(ordinal);
  PathState& path = pool_.state(index);
  // Relaxed and plain: no other thread knows this path until the engine has handed its ray over.
  for (auto& channel : path.radiance) channel.store(0, std::memory_order_relaxed);
  path.outstanding.store(1, std::memory_order_relaxed);
  path.pixel = at.y * film_.width() + at.x;
  path.sample = at.sample;
  path.throughput = Vec3{1};
  path.bounce_pdf = 0;
  path.behind = 0;
  path.scattered = false;
  if (media_) pool_.volumes(index) = {};
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
  return {admitted.count, paths_.begin(admitted.count)};
}

void PathTracer::shade(WorkerId worker_id, const HitBatch& completed, RayBatch& out) {
  const scene::Material* first = scene_.materials.data();
  const auto surface = [&](const RayResult& result, const TrianglePoint& point, Worker& worker, RayBatch& rays,
                           std::uint32_t& children) {
    (this->*surfaces_[static_cast<std::size_t>(point.material - first)].shade)(result, point, worker, rays, children);
  };
  if (media_)
    shade_batch<true>(worker_id, completed, out, surface);
  else
    shade_batch<false>(worker_id, completed, out, surface);
}

ShadeWork PathTracer::extra_work(const RayResult& result) const {
  const Hit& hit = result.hit;
  const bool shadow = result.tag.kind == RayKind::kShadow;
  if (!hit.valid()) return shadow ? ShadeWork{} : miss_work_;
  if (!any_work_ || (shadow && !panes_)) return {};
  const TrianglePoint point = triangle_point(scene_, hit.instance, hit.primitive, hit.u, hit.v);
  const Surface& surface = surfaces_[static_cast<std::size_t>(point.material - scene_.materials.data())];
  return shadow && !surface.pane ? ShadeWork{} : surface.work;
}

void PathTracer::sky_reads(const RayResult& result, std::vector<SkyRead>& out) const {
  if (!lights_.has_sky() || result.tag.kind == RayKind::kShadow) return;
  const Hit& hit = result.hit;
  if (!hit.valid() || !scene_.gaussians.empty()) return lights_.append_sky_reads(result.ray.direction, out);
  if (triangle_point(scene_, hit.instance, hit.primitive, hit.u, hit.v).material->unlit) return;
  const PathState& path = pool_.state(result.tag.path);
  lights_.append_sky_reads(sampler_.light(path.pixel, path.sample, result.tag.bounce), out);
}

ShadeFacts PathTracer::shade_facts(const RayResult& result) const {
  ShadeFacts facts = Workload::shade_facts(result);
  const ShadeWork work = extra_work(result);
  facts[ShadeFact::kLast] = result.tag.bounce + 1u >= max_depth_ ? 1.0f : 0.0f;
  facts[ShadeFact::kLights] = static_cast<float>(lights_.count());
  facts[ShadeFact::kLookups] = static_cast<float>(work.lookups);
  facts[ShadeFact::kProducts] = static_cast<float>(work.products);
  const Hit& hit = result.hit;
  if (!hit.valid() || !scene_.gaussians.empty()) return facts;
  const TrianglePoint point = triangle_point(scene_, hit.instance, hit.primitive, hit.u, hit.v);
  facts[ShadeFact::kEmissive] = is_emissive(*point.material) ? 1.0f : 0.0f;
  facts[ShadeFact::kAlpha] = static_cast<float>(point.material->alpha_mode);
  // A shadow ray looks at no surface but a pane.
  const Surface& surface = surfaces_[static_cast<std::size_t>(point.material - scene_.materials.data())];
  if (result.tag.kind != RayKind::kShadow || surface.pane) tables_.reads(hit, point, facts);
  return facts;
}

/// What AlphaTest does: it looks up the base colour's texture for its alpha.
ShadeFacts PathTracer::any_hit_facts(const RayResult& call) const {
  ShadeFacts facts = Workload::shade_facts(call);
  const Hit& at = call.hit;
  const TrianglePoint point = triangle_point(scene_, at.instance, at.primitive, at.u, at.v);
  const scene::Material& material = *point.material;
  facts[ShadeFact::kAlpha] = static_cast<float>(material.alpha_mode);
  tables_.opacity_reads(at, point, facts);
  facts[ShadeFact::kLookups] = static_cast<float>(facts.lookups.size());
  return facts;
}

std::uint32_t PathTracer::shader(const RayResult& result) const {
  constexpr std::uint32_t kMiss = 0, kShadow = 1;
  const Hit& hit = result.hit;
  if (result.tag.kind == RayKind::kShadow) return kShadow;
  if (!hit.valid()) return kMiss;
  const TrianglePoint point = triangle_point(scene_, hit.instance, hit.primitive, hit.u, hit.v);
  const Surface& surface = surfaces_[static_cast<std::size_t>(point.material - scene_.materials.data())];
  return kFirstSurfaceKind + static_cast<std::uint32_t>(surface.code);
}

void PathTracer::shade_shadow(const RayResult& result, Worker& worker, RayBatch& out, std::uint32_t& children) {
  if (result.hit.valid()) {
    if (panes_) pass_shadow(result, worker, out, children);
    return;
  }
  add_radiance(pool_.state(result.tag.path), pool_.shadow_contribution(result.tag.path, result.tag.bounce), worker);
}

void PathTracer::shade_miss(const RayResult& result, Worker& worker) {
  PathState& path = pool_.state(result.tag.path);
  const Vec3& direction = result.ray.direction;
  Vec3 radiance = scene_.sky.radiance;
  if (lights_.has_sky()) {
    const SkyLight::Seen seen = lights_.sky(direction);
    // Light was sampled from the surface that a bounce ray comes from, panes or not.
    const bool shared = result.tag.kind == RayKind::kBounce;
    radiance += seen.radiance * (shared ? detail::balance(path.bounce_pdf, seen.pdf) : 1.0f);
  }
  add_radiance(path, path.throughput * radiance, worker);
}

Vec3 PathTracer::passed(std::uint32_t medium, float distance) const {
  const Vec3& a = surfaces_[medium - 1].absorption;
  return {exp_float(-a.x * distance), exp_float(-a.y * distance), exp_float(-a.z * distance)};
}

/// Applies the Beer-Lambert law over the way to the hit. A ray that leaves the scene from within a volume has found a
/// hole in the hull and keeps its light.
void PathTracer::absorb(const RayResult& result) {
  const std::uint32_t medium = pool_.volumes(result.tag.path).innermost();
  if (medium != 0) pool_.state(result.tag.path).throughput *= passed(medium, result.hit.t);
}

template <PathTracer::Lights kLights>
PathTracer::ShadeSurface PathTracer::shade_of(SurfaceClass surface) {
  using C = SurfaceClass;
  switch (surface) {
    case C::kUnlit:
      return &PathTracer::shade_surface<C::kUnlit, kLights>;
    case C::kPlain:
      return &PathTracer::shade_surface<C::kPlain, kLights>;
    case C::kTextured:
      return &PathTracer::shade_surface<C::kTextured, kLights>;
    case C::kLayered:
      return &PathTracer::shade_surface<C::kLayered, kLights>;
    case C::kOpaque:
      return &PathTracer::shade_surface<C::kOpaque, kLights>;
    case C::kLayeredOpaque:
      return &PathTracer::shade_surface<C::kLayeredOpaque, kLights>;
    case C::kTransmissive:
      return &PathTracer::shade_surface<C::kTransmissive, kLights>;
    case C::kLayeredTransmissive:
      return &PathTracer::shade_surface<C::kLayeredTransmissive, kLights>;
    case C::kAnything:
      break;
  }
  return &PathTracer::shade_surface<C::kAnything, kLights>;
}

PathTracer::ShadeSurface PathTracer::shade_of(SurfaceClass surface, Lights lights) {
  switch (lights) {
    case Lights::kNone:
      return shade_of<Lights::kNone>(surface);
    case Lights::kPunctual:
      return shade_of<Lights::kPunctual>(surface);
    case Lights::kEmissive:
      return shade_of<Lights::kEmissive>(surface);
    case Lights::kEmissiveAndMedia:
      break;
  }
  return shade_of<Lights::kEmissiveAndMedia>(surface);
}

void PathTracer::choose_surfaces() {
  const std::vector<SurfaceClass> classes = surface_classes(scene_, plan_);
  const std::vector<ShaderParts> parts = parts_of_materials(scene_);
  const std::vector<ShadeWork> work = shading::extra_work(scene_, plan_);
  miss_work_ = extra_work_of_misses(plan_);
  const Lights lights = media_                        ? Lights::kEmissiveAndMedia
                        : plan_.on(Effect::kEmission) ? Lights::kEmissive
                        : !lights_.empty()            ? Lights::kPunctual
                                                      : Lights::kNone;
  surfaces_.resize(scene_.materials.size());
  for (std::size_t i = 0; i < surfaces_.size(); ++i) {
    const scene::Material& material = scene_.materials[i];
    Surface& surface = surfaces_[i];
    surface.shade = shade_of(classes[i], lights);
    surface.glass = glass_tables(material);
    surface.work = work[i];
    surface.code = classes[i];
    any_work_ |= work[i] != ShadeWork{};
    surface.boundary = parts[i] & kBoundary;
    surface.pane = panes_ && is_pane(material);
    if (!absorbs(material)) continue;
    for (int c = 0; c < 3; ++c) {
      const float left = std::clamp(material.volume.attenuation_color[c], 1e-6f, 1.0f);
      surface.absorption[c] = static_cast<float>(-log2_double(double{left}) * 0.69314718055994530942) /
                              material.volume.attenuation_distance;
    }
  }
}

void PathTracer::add_emission(PathState& path, const RayResult& result, const TriangleGeometry& geometry,
                              const TrianglePoint& point, bool front, Worker& worker) {
  if (!emits(*point.material, front)) return;
  float weight = 1.0f;
  if (result.tag.kind == RayKind::kBounce) {
    const float cos_light = std::abs(glm::dot(Vec3(geometry.normal), result.ray.direction));
    Hit from_surface = result.hit;  // light was sampled from there, panes or not
    from_surface.t += path.behind;
    weight = detail::balance(path.bounce_pdf, lights_.primitive_pdf(from_surface, geometry, front, cos_light));
  }
  add_radiance(path, path.throughput * emitted(scene_, point) * weight, worker);
}

void PathTracer::add_radiance(PathState& path, const Vec3& radiance, Worker& worker) {
  for (int c = 0; c < 3; ++c) {
    const std::int64_t term = to_fixed_point(radiance[c], worker.counts.saturated);
    // Relaxed: finish_ray()'s decrement, which follows, publishes it to the thread that commits the path.
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
  wishing.flags |= ray_flags_[static_cast<std::size_t>(tag.kind)];
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
