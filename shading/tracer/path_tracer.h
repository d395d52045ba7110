#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "core/config/config.h"
#include "core/numeric/digest.h"
#include "core/types/workload.h"
#include "scene/model/scene.h"
#include "shading/camera/camera_rays.h"
#include "shading/camera/film.h"
#include "shading/camera/path_sample.h"
#include "shading/camera/pixel_order.h"
#include "shading/effects/effects_plan.h"
#include "shading/lights/light_set.h"
#include "shading/math/sampler.h"
#include "shading/path/frame_paths.h"
#include "shading/path/path_pool.h"
#include "shading/raster/first_hits.h"
#include "shading/surface/surface.h"
#include "shading/surface/surface_layers.h"
#include "shading/tracer/ray_recorder.h"
#include "shading/tracer/shade_tables.h"
#include "shading/tracer/surface_class.h"

namespace carousel::shading {

/// One frame by path tracing: camera rays, at each surface one shadow ray and one bounce ray, weighted by
/// multiple importance sampling (E. Veach, L. Guibas, SIGGRAPH 1995, balance heuristic), Russian roulette
/// from the fourth surface on. Image and hits digest are the same bits for any number of workers, any cutting
/// of batches and any order. Each material is shaded by the least code that has all effects it calls for, chosen once
/// (surface_class.h). Shadow rays pass panes (surface/pane.h), which count among the surfaces of a path, and treat
/// other transmissive surfaces as opaque: light passes these by bounce rays alone, and at points of glass by shadow
/// rays on either side. The last of `image.max_depth` surfaces sends no bounce ray: light from a sky of
/// one colour, which only such rays find, is not seen there.
class PathTracer : public Workload {
 public:
  /// Keeps a reference to `scene`, which has been through strip_effects() with config.shading.effects. At most
  /// `max_paths_in_flight` paths have rays out at a time, 1 if 0 is given. Preconditions, which the config's ranges
  /// ensure: image.width, height and samples at least 1, max_depth 1 to 255, width * height below 2^32. Throws
  /// std::out_of_range if the scene has no camera `scene.camera`.
  PathTracer(const scene::Scene& scene, const Config& config, std::size_t max_paths_in_flight, std::size_t workers);
  ~PathTracer() override;

  /// Every completed ray is reported to `recorder`, which must outlive the tracing; null turns the reports off. Call
  /// before the first generate().
  void set_recorder(RayRecorder* recorder) { recorder_ = recorder; }

  /// Paths start at these hits, and need no camera ray where the hit is known; `hits` must outlive the tracing. Null:
  /// all paths start with a ray. Call before the first generate().
  void set_first_hits(const FirstHits* hits) { first_hits_ = hits; }

  /// Only these paths of the frame are traced, in their order; `sample` must outlive the tracing. Call before the first
  /// generate().
  void set_sample(const PathSample* sample);

  Generated generate(WorkerId worker, std::size_t max_rays, RayBatch& out) override;
  void shade(WorkerId worker, const HitBatch& completed, RayBatch& out) override;
  ShadeWork extra_work(const RayResult& result) const override;
  /// Shading a miss, a shadow ray, or a hit of one class of surfaces.
  std::uint32_t shader(const RayResult& result) const override;
  void sky_reads(const RayResult& result, std::vector<SkyRead>& out) const override;
  ShadeFacts shade_facts(const RayResult& result) const override;
  ShadeFacts any_hit_facts(const RayResult& call) const override;
  PathMemory path_memory(const RayTag& tag) const override {
    return {plan_.path_state_bytes(), pool_.state(tag.path).pixel};
  }

  /// Pixel and sample of a path whose rays are in flight.
  std::pair<std::uint32_t, std::uint32_t> place_of(std::uint32_t path) const {
    return {pool_.state(path).pixel, pool_.state(path).sample};
  }

  const EffectsPlan& plan() const { return plan_; }

  // The results below are valid once the frame is done and the workers are joined.

  struct Counts {
    std::array<std::uint64_t, kRayKinds> emitted{};  ///< rays by RayKind
    std::array<std::uint64_t, kRayKinds> completed{};
    std::uint64_t saturated = 0;  ///< radiance values that were not finite or beyond fixed point's range
    std::uint64_t paths = 0;      ///< committed to the film
  };
  Counts counts() const;
  HitsDigest hits_digest() const;
  /// Digest of linear_rgb().
  std::string image_digest() const;
  /// All results as numbers of which those of several tracers, each with other paths of one frame, are added up modulo
  /// 2^64.
  std::vector<std::uint64_t> sums() const;
  /// Takes the sums for this tracer's own results.
  void set_sums(const std::vector<std::uint64_t>& sums);
  std::vector<float> linear_rgb() const { return film_.linear_rgb(); }
  std::uint32_t width() const { return film_.width(); }
  std::uint32_t height() const { return film_.height(); }

 protected:
  struct Worker;

  /// The kinds of lights in the frame, and whether volumes absorb. All surfaces of a frame share one value.
  enum class Lights : std::uint8_t { kNone, kPunctual, kEmissive, kEmissiveAndMedia };

  /// The body of shade(). `shade_hit` shades a ray's hit; it is a template argument so that the call can be inlined.
  template <bool kMedia, class ShadeHit>
  void shade_batch(WorkerId worker, const HitBatch& completed, RayBatch& out, const ShadeHit& shade_hit);
  template <SurfaceClass kClass, Lights kLights>
  void shade_surface(const RayResult& result, const TrianglePoint& point, Worker& worker, RayBatch& out,
                     std::uint32_t& children);

 private:
  using ShadeSurface = void (PathTracer::*)(const RayResult&, const TrianglePoint&, Worker&, RayBatch&, std::uint32_t&);
  /// The shading of a material's hits.
  struct Surface {
    ShadeSurface shade = nullptr;
    GlassTables glass;
    Vec3 absorption{0};     ///< per scene unit, inside
    bool boundary = false;  ///< ShaderParts::kBoundary
    bool pane = false;      ///< light passes it straight on, by Effect::kTransparentShadows
    ShadeWork work;         ///< extra_work()
    SurfaceClass code{};    ///< that shades it
  };

  static ShadeSurface shade_of(SurfaceClass surface, Lights lights);
  template <Lights kLights>
  static ShadeSurface shade_of(SurfaceClass surface);
  void choose_surfaces();
  template <SurfaceClass kClass, Lights kLights, class SomeBsdf>
  void scatter(const RayResult& result, const TrianglePoint& point, const TriangleGeometry& geometry,
               const Vec3& facing, bool front, const ShadingBasis& frame, const SomeBsdf& bsdf, Worker& worker,
               RayBatch& out, std::uint32_t& children);
  void absorb(const RayResult& result);
  Vec3 passed(std::uint32_t medium, float distance) const;
  void shade_miss(const RayResult& result, Worker& worker);
  void shade_gaussians(const RayResult& result, Worker& worker);
  /// Starts path `ordinal` of the frame in state `index`.
  PixelSample begin_path(std::uint64_t ordinal, std::uint32_t index);
  Generated generate_from_hits(WorkerId worker, std::size_t max_rays, RayBatch& out);
  /// Shades a first hit that was found without a camera ray.
  void shade_first(const RayResult& result, Worker& worker, RayBatch& out);
  void shade_shadow(const RayResult& result, Worker& worker, RayBatch& out, std::uint32_t& children);
  /// A shadow ray that has met a surface goes on behind it, with less light, if that is a pane.
  void pass_shadow(const RayResult& result, Worker& worker, RayBatch& out, std::uint32_t& children);
  /// Chooses whether a path goes straight on at a pane, and if so sends it on. If not, its throughput makes up for
  /// that.
  bool pass_pane(const RayResult& result, const TriangleGeometry& geometry, bool front, const InterfacePoint& pane,
                 float cosine, Worker& worker, RayBatch& out, std::uint32_t& children);
  void add_emission(PathState& path, const RayResult& result, const TriangleGeometry& geometry,
                    const TrianglePoint& point, bool front, Worker& worker);
  void add_radiance(PathState& path, const Vec3& radiance, Worker& worker);
  void finish_ray(std::uint32_t path, std::uint32_t children, Worker& worker);
  void emit(const Ray& ray, const RayTag& tag, Worker& worker, RayBatch& out);

  const scene::Scene& scene_;
  const EffectsPlan plan_;
  const std::uint32_t max_depth_;  // 1 if there is nothing for bounce rays to find
  const SpawnOffset spawn_;
  const std::array<std::uint8_t, kRayKinds> ray_flags_;
  const Sampler sampler_;
  FramePaths paths_;
  const CameraRays camera_;
  const LightSet lights_;
  const bool media_, panes_;
  bool any_work_ = false;          ///< a material has extra_work()
  ShadeWork miss_work_;            ///< of a ray that leaves the scene
  std::vector<Surface> surfaces_;  // by material
  const ShadeTables tables_;
  PathPool pool_;
  Film film_;
  std::unique_ptr<Worker[]> workers_;
  std::size_t worker_count_;
  RayRecorder* recorder_ = nullptr;
  const FirstHits* first_hits_ = nullptr;
};

}  // namespace carousel::shading
