#include "app/run/render_job.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "app/run/memory_need.h"
#include "core/system/executor.h"
#include "report/csv/ray_csv.h"
#include "ringbus/cycle/bottleneck_search.h"
#include "shading/camera/image_file.h"

namespace carousel::app {

RenderJob::RenderJob(const Prepared& prepared, const Config& config, const shading::FirstHits* first_hits)
    : seed_(static_cast<std::uint64_t>(config.image.seed)),
      exposure_(config.image.exposure),
      order_(static_cast<std::uint32_t>(config.image.width), static_cast<std::uint32_t>(config.image.height),
             static_cast<std::uint32_t>(config.image.samples)) {
  const auto workers = static_cast<std::size_t>(shader_workers(config));
  if (config.workload.kind == WorkloadConfig::Kind::kRaysFrom) {
    const auto path = find_beside(prepared.config_folder, config.workload.rays_from);
    RayBatch rays = report::read_rays_csv(path);
    if (config.rays.query == Query::kAny) {
      for (RayRequest& ray : rays) {
        ray.tag.kind = RayKind::kShadow;  // the kind whose way ends at any hit
        ray.tag.flags &= static_cast<std::uint8_t>(~kRayClosest);
      }
    }
    list_ = std::make_unique<RayListWorkload>(std::move(rays), workers);
    frame_rays_ = list_->size();
  } else {
    tracer_ = std::make_unique<shading::PathTracer>(prepared.scene, config, paths_in_flight(config), workers);
    if (first_hits != nullptr) {
      tracer_->set_first_hits(first_hits);
    } else if (config.primary == Primary::kRaster) {
      const auto start = std::chrono::steady_clock::now();
      first_hits_ = shading::rasterize_first_hits(prepared.scene, config, prepared.alpha_test.get(),
                                                  *make_tbb_executor(prepared.threads));
      tracer_->set_first_hits(&first_hits_);
      raster_seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    }
    frame_rays_ = order_.count();
  }
  if (config.sampling.fraction < 1) draw_sample(config);
}

/// Places of several times as many paths as the machine has slots, so that most of the time it holds rays of one place,
/// as it holds those of one part of the frame; but enough of them to be a mix of the frame.
std::uint64_t RenderJob::strata_of(const Config& config, std::uint64_t rays) {
  constexpr std::uint64_t kLeast = 16;
  if (config.sampling.strata) return static_cast<std::uint64_t>(*config.sampling.strata);
  return std::max(kLeast, rays / (2 * ringbus::slots_of(config)));
}

void RenderJob::draw_sample(const Config& config) {
  const auto seed = static_cast<std::uint64_t>(config.sampling.seed);
  const auto rays = std::max<std::uint64_t>(
      1, static_cast<std::uint64_t>(std::llround(config.sampling.fraction * static_cast<double>(frame_rays_))));
  if (list_)
    drawn_ = shading::draw_list(frame_rays_, rays, seed);
  else
    drawn_ = shading::draw_places(order_, rays, strata_of(config, rays), order_.samples(), seed);
  set_sample(&*drawn_);
}

shading::PathSample RenderJob::draw(std::uint64_t paths, std::uint64_t together) const {
  return tracer_ ? shading::draw_tiles(order_, paths, together, seed_) : shading::draw_list(frame_rays_, paths, seed_);
}

void RenderJob::set_sample(const shading::PathSample* sample) {
  if (tracer_) tracer_->set_sample(sample);
  if (list_) list_->set_sample(sample);
}

void RenderJob::share(ringbus::Transport& ranks) {
  ranks_ = &ranks;
  share_ = shading::share_of_paths(frame_rays_, ranks.rank(), ranks.ranks());
  set_sample(&*share_);
}

void RenderJob::join() {
  std::vector<std::uint64_t> sums = tracer_->sums();
  ranks_->sum(sums);
  if (ranks_->rank() == 0) tracer_->set_sums(sums);
}

Workload& RenderJob::workload() const {
  return tracer_ ? static_cast<Workload&>(*tracer_) : *list_;
}

void RenderJob::set_recorder(shading::RayRecorder* recorder) {
  if (tracer_) tracer_->set_recorder(recorder);
  if (list_) list_->set_recorder(recorder);
}

std::pair<std::uint32_t, std::uint32_t> RenderJob::place_of(std::uint32_t path) const {
  return tracer_ ? tracer_->place_of(path) : std::pair{path, 0u};
}

std::uint64_t RenderJob::pieces() const {
  if (list_) return frame_rays_ / shading::kListRun + 1;
  return std::uint64_t{order_.tile_columns()} * order_.tile_rows();
}

std::uint64_t RenderJob::piece_at(std::uint64_t ordinal) const {
  if (list_) return ordinal / shading::kListRun;
  const shading::PixelSample at = order_.at(ordinal);
  return order_.tile_of(at.x, at.y);
}

std::uint64_t RenderJob::piece_of(std::uint32_t path) const {
  if (list_) return path / shading::kListRun;
  const std::uint32_t pixel = tracer_->place_of(path).first;
  return order_.tile_of(pixel % tracer_->width(), pixel / tracer_->width());
}

std::array<std::uint64_t, kRayKinds> RenderJob::emitted() const {
  return tracer_ ? tracer_->counts().emitted : list_->emitted();
}

std::uint64_t RenderJob::saturated() const {
  return tracer_ ? tracer_->counts().saturated : 0;
}

std::string RenderJob::hits_digest() const {
  return (tracer_ ? tracer_->hits_digest() : list_->hits_digest()).hex();
}

std::optional<std::string> RenderJob::image_digest() const {
  return tracer_ && !drawn_ ? std::optional(tracer_->image_digest()) : std::nullopt;
}

std::optional<RasterCounts> RenderJob::raster() const {
  return raster_seconds_ ? std::optional(first_hits_.counts) : std::nullopt;
}

void RenderJob::write_images(const std::filesystem::path& folder) const {
  if (!tracer_) return;
  const std::vector<float> rgb = tracer_->linear_rgb();
  shading::write_png(folder / "image.png", tracer_->width(), tracer_->height(), rgb, exposure_);
  shading::write_exr(folder / "image.exr", tracer_->width(), tracer_->height(), rgb);
}

}  // namespace carousel::app
