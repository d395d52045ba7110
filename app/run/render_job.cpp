#include "app/run/render_job.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <random>

#include <fmt/format.h>

#include "app/run/memory_need.h"
#include "core/system/executor.h"
#include "report/csv/ray_csv.h"
#include "ringbus/verdict/bottleneck_search.h"
#include "shading/camera/image_file.h"

namespace carousel::app {

RenderJob::RenderJob(const Prepared& prepared, const Config& config, const shading::FirstHits* first_hits)
    : seed_(static_cast<std::uint64_t>(config.image.seed)),
      exposure_(config.image.exposure),
      files_(config.image.files),
      order_(static_cast<std::uint32_t>(config.image.width), static_cast<std::uint32_t>(config.image.height),
             static_cast<std::uint32_t>(config.image.samples)) {
  const auto workers = static_cast<std::size_t>(shader_workers(config));
  if (config.workload.kind == WorkloadConfig::Kind::kRaysFrom) {
    const auto path = find_beside(prepared.config_folder, config.workload.rays_from);
    RayBatch rays = report::read_rays_csv(path);
    if (config.rays.query.hits == Query::kAny) {
      for (RayRequest& ray : rays) {
        ray.tag.kind = RayKind::kShadow;  // the kind whose way ends at any hit
        ray.tag.flags &= static_cast<std::uint8_t>(~kRayClosest);
      }
    }
    if (config.rays.query.hits == Query::kAll) {
      for (RayRequest& ray : rays) {
        if (ray.tag.kind == RayKind::kShadow) ray.tag.kind = RayKind::kCamera;  // no hit ends its way
        ray.tag.flags |= kRayAll;
      }
    }
    list_ = std::make_unique<RayListWorkload>(std::move(rays), workers, prepared.all_hits.get());
    frame_rays_ = list_->size();
  } else if (config.workload.kind == WorkloadConfig::Kind::kPlugin) {
    own_ =
        std::make_unique<OwnRays>(config.workload.own,
                                  WorkloadSetup{workers, prepared.scene.bounds(),
                                                static_cast<std::uint64_t>(config.image.seed), config.workload.options},
                                  prepared.located.positions);
    frame_rays_ = own_->first_rays();
  } else {
    shading::require_picture_files(files_);
    tracer_ = std::make_unique<shading::PathTracer>(prepared.scene, config, paths_in_flight(config), workers);
    if (first_hits != nullptr) {
      tracer_->set_first_hits(first_hits);
    } else if (config.primary == Primary::kRaster) {
      const auto start = std::chrono::steady_clock::now();
      first_hits_ = shading::rasterize_first_hits(prepared.scene, config, prepared.alpha_test.get(),
                                                  *make_executor(prepared.threads));
      tracer_->set_first_hits(&first_hits_);
      raster_seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    }
    frame_rays_ = order_.count();
  }
  if (config.sampling.fraction < 1)
    draw_sample(prepared, config, first_hits != nullptr ? first_hits : this->first_hits());
}

/// Places of several times as many paths as the machine has slots, so that most of the time it holds rays of one place,
/// as it holds those of one part of the frame; but enough of them to be a mix of the frame.
std::uint64_t RenderJob::strata_of(const Config& config, std::uint64_t rays) {
  constexpr std::uint64_t kLeast = 10;
  if (config.sampling.strata) return static_cast<std::uint64_t>(*config.sampling.strata);
  return std::max(kLeast, rays / (2 * ringbus::slots_of(config)));
}

shading::PathSample RenderJob::spread(std::uint64_t one_in, std::uint64_t seed) const {
  std::mt19937_64 random(seed);
  std::vector<shading::PathSample::Run> runs;
  for (std::uint64_t begin = 0; begin < frame_rays_; begin += one_in)
    runs.push_back({begin + random() % std::min(one_in, frame_rays_ - begin), 1, 0});
  return shading::PathSample(runs);
}

RenderJob::PieceWork RenderJob::survey(const Prepared& prepared, const Config& config,
                                       const shading::FirstHits* first_hits, std::uint64_t one_in, std::uint64_t least,
                                       std::uint64_t seed) const {
  constexpr std::uint64_t kMostPaths = 1 << 16;
  Config all = config;
  all.sampling = {};
  RenderJob frame(prepared, all, first_hits);
  const std::uint64_t traced = std::clamp(frame_rays_ / one_in, least, kMostPaths);
  const shading::PathSample some = spread(std::max<std::uint64_t>(1, frame_rays_ / traced), seed);
  frame.set_sample(&some);
  const std::vector<accel::ReferenceRun> runs = accel::run_reference_by_piece(
      prepared.accel, frame.workload(), pieces(), [&frame](const RayTag& tag) { return frame.piece_of(tag.path); });
  PieceWork work;
  for (const accel::ReferenceRun& run : runs)
    work.push_back({0, static_cast<double>(run.rays), static_cast<double>(run.tests.box),
                    static_cast<double>(run.tests.triangle + run.tests.procedural)});
  for (const shading::PathSample::Run& run : some.runs()) ++work[piece_at(run.first)][0];
  return work;
}

template <class Draw>
shading::PathSample RenderJob::most_like(const PieceWork& work, const Draw& draw, std::uint64_t first) const {
  constexpr std::uint64_t kDraws = 500;
  constexpr double kTime = 4;  // weight of the cycles, which a pilot is judged by
  using Sum = PieceWork::value_type;
  const auto add = [&work](Sum& to, std::uint64_t piece) {
    for (std::size_t i = 0; i < to.size(); ++i) to[i] += work[piece][i];
  };
  Sum whole{};
  for (std::uint64_t piece = 0; piece < work.size(); ++piece) add(whole, piece);
  shading::PathSample best = draw(first * kDraws);
  double least = std::numeric_limits<double>::infinity();
  for (std::uint64_t k = first * kDraws; k < (first + 1) * kDraws && !work.empty(); ++k) {
    shading::PathSample sample = draw(k);
    Sum own{};
    for (const shading::PathSample::Run& run : sample.runs()) add(own, piece_at(run.first));
    double off = 0;
    for (std::size_t i = 1; i < own.size(); ++i)
      if (own[0] > 0 && whole[i] > 0)
        off += (i == kTraced ? kTime : 1) * std::pow(own[i] / own[0] * whole[0] / whole[i] - 1, 2);
    if (off >= least) continue;
    least = off;
    best = std::move(sample);
  }
  return best;
}

/// Draws many samples by position, and keeps the one whose rays and tests a path, traced depth-first, are most nearly
/// those of the frame: rejective sampling (W. A. Fuller, Some design properties of a rejective sampling procedure,
/// Biometrika 96, 2009). That costs little beside a simulation, and the part of a path's cycles that is due to its rays
/// and tests is then no error of the sample. Rays and tests of the pieces are themselves estimated, from some of the
/// paths.
void RenderJob::draw_sample(const Prepared& prepared, const Config& config, const shading::FirstHits* first_hits) {
  constexpr std::uint64_t kOneIn = 8, kLeastPaths = 1 << 14;
  const auto start = std::chrono::steady_clock::now();
  const auto seed = static_cast<std::uint64_t>(config.sampling.seed);
  const auto rays = std::max<std::uint64_t>(
      1, static_cast<std::uint64_t>(std::llround(config.sampling.fraction * static_cast<double>(frame_rays_))));
  const PieceWork work = survey(prepared, config, first_hits, kOneIn, kLeastPaths, seed);
  drawn_ = most_like(work, [&](std::uint64_t draw) {
    return list_ ? shading::draw_list(frame_rays_, rays, seed, draw)
                 : shading::draw_places(order_, rays, strata_of(config, rays), order_.samples(), seed, draw);
  });
  set_sample(&*drawn_);
  draw_seconds_ = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

shading::PathSample RenderJob::draw(std::uint64_t paths, std::uint64_t together, std::optional<std::uint64_t> seed,
                                    const PieceWork& work, std::uint64_t draw) const {
  const std::uint64_t by = seed.value_or(seed_);
  return most_like(
      work,
      [&](std::uint64_t k) {
        return tracer_ ? shading::draw_tiles(order_, paths, together, by, k)
                       : shading::draw_list(frame_rays_, paths, by, k);
      },
      draw);
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
  if (own_) return *own_;
  return tracer_ ? static_cast<Workload&>(*tracer_) : *list_;
}

void RenderJob::set_recorder(shading::RayRecorder* recorder) {
  if (tracer_) tracer_->set_recorder(recorder);
  if (list_) list_->set_recorder(recorder);
  if (own_) own_->set_recorder(recorder);
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
  if (own_) return own_->emitted();
  return tracer_ ? tracer_->counts().emitted : list_->emitted();
}

std::uint64_t RenderJob::saturated() const {
  return tracer_ ? tracer_->counts().saturated : 0;
}

std::string RenderJob::hits_digest() const {
  if (own_) return own_->hits_digest().hex();
  return (tracer_ ? tracer_->hits_digest() : list_->hits_digest()).hex();
}

std::optional<std::string> RenderJob::image_digest() const {
  return tracer_ && !drawn_ ? std::optional(tracer_->image_digest()) : std::nullopt;
}

std::optional<RasterCounts> RenderJob::raster() const {
  return raster_seconds_ ? std::optional(first_hits_.counts) : std::nullopt;
}

void RenderJob::write_images(const std::filesystem::path& folder, std::optional<std::int64_t> frame) const {
  if (!tracer_) return;
  const std::vector<float> rgb = tracer_->linear_rgb();
  const std::string stem = frame ? fmt::format("image.{:04}", *frame) : "image";
  for (const PictureFile format : files_)
    shading::write_picture(folder / fmt::format("{}.{}", stem, enum_name(format)), format, tracer_->width(),
                           tracer_->height(), rgb, exposure_);
}

}  // namespace carousel::app
