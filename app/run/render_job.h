#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "accel/traverse/reference_tracer.h"
#include "app/plugins/own_rays.h"
#include "app/run/prepare.h"
#include "app/run/ray_list_workload.h"
#include "report/run/report.h"
#include "ringbus/transport/transport.h"
#include "shading/raster/first_hits.h"
#include "shading/tracer/path_tracer.h"

namespace carousel::app {

/// The rays of a run: those of a picture, of a file or of a plugin, as configured.
class RenderJob {
 public:
  /// Reads the file of `rays_from`. Keeps references to `prepared`. Throws ConfigError and FileError.
  explicit RenderJob(const Prepared& prepared) : RenderJob(prepared, prepared.config()) {}
  /// A job for another machine than the prepared one, for what-if runs. `first_hits`, if not null, replaces a raster
  /// pass, and must outlive the job.
  RenderJob(const Prepared& prepared, const Config& config, const shading::FirstHits* first_hits = nullptr);

  /// Work of some paths of each piece of the frame, traced depth-first: paths, rays, box tests and other tests; then,
  /// if it is known, what they took on the machine: cycles, and the busy cycles of two classes of parts.
  using PieceWork = std::vector<std::array<double, 7>>;
  static constexpr std::size_t kTraced = 4;  ///< numbers of a piece that come of tracing
  /// Traces one path in `one_in` of the frame of this configuration, but `least` or more.
  PieceWork survey(const Prepared& prepared, const Config& config, const shading::FirstHits* first_hits,
                   std::uint64_t one_in, std::uint64_t least, std::uint64_t seed) const;
  /// Draws about `paths` of the first rays, over all of them, for a pilot: tiles of the picture, places of at least
  /// `together` paths if they are many, or runs of the list. Of many draws it is the one whose work is most like that
  /// of the frame; others with another `draw`. Without `work`: the first. `seed`: if not that of the picture.
  shading::PathSample draw(std::uint64_t paths, std::uint64_t together,
                           std::optional<std::uint64_t> seed = std::nullopt, const PieceWork& work = {},
                           std::uint64_t draw = 0) const;
  /// Only these of the first rays are traced; `sample` must outlive the job. Before the first ray.
  void set_sample(const shading::PathSample* sample);
  /// The paths that `sampling` draws; null if the whole frame is traced.
  const shading::PathSample* sample() const { return drawn_ ? &*drawn_ : nullptr; }

  /// Only this rank's share of the paths is traced. Keeps a reference. Before the first ray.
  void share(ringbus::Transport& ranks);
  /// The ranks of the run; null if there is one.
  ringbus::Transport* ranks() const { return ranks_; }
  /// Brings the results of all ranks to rank 0. Every rank calls.
  void join();

  Workload& workload() const;
  /// A part of its first rays can be traced by itself; not so of a plugin's, which go their own way.
  bool divisible() const { return own_ == nullptr; }
  void set_recorder(shading::RayRecorder* recorder);
  /// Pixel and sample of a path whose rays are in flight; of a ray of a list its number and 0.
  std::pair<std::uint32_t, std::uint32_t> place_of(std::uint32_t path) const;
  /// The number of rays that no other ray causes, by which progress is measured.
  std::uint64_t first_rays() const { return drawn_ ? drawn_->count() : share_ ? share_->count() : frame_rays_; }
  /// That number for the whole frame, of which `sampling` may draw a part.
  std::uint64_t frame_rays() const { return frame_rays_; }

  /// Number of the pieces of the frame that a sample consists of: tiles of the picture, or runs of the list.
  std::uint64_t pieces() const;
  /// The piece of a first ray, by its number in the frame.
  std::uint64_t piece_at(std::uint64_t ordinal) const;
  /// The piece of a path whose rays are in flight.
  std::uint64_t piece_of(std::uint32_t path) const;

  /// The time that it took to draw the sample, most of it to trace a part of the frame; absent without a sample.
  std::optional<double> draw_seconds() const { return draw_seconds_; }

  /// The result of the raster pass; null if rays find the first hits.
  const shading::FirstHits* first_hits() const { return raster_seconds_ ? &first_hits_ : nullptr; }

  // The results below are valid once the workers are joined.

  std::array<std::uint64_t, kRayKinds> emitted() const;  ///< by RayKind
  std::uint64_t saturated() const;
  std::string hits_digest() const;
  /// Absent if the rays make no picture, or a part of one.
  std::optional<std::string> image_digest() const;
  /// Counts and time of the rasteriser; absent if rays found the first hits.
  std::optional<RasterCounts> raster() const;
  std::optional<double> raster_seconds() const { return raster_seconds_; }
  /// Writes the files of image.files if there is a picture. Pixels that `sampling` has not drawn are black. Those of a
  /// frame of a series have its number in their names, as image.0007.png has.
  void write_images(const std::filesystem::path& folder, std::optional<std::int64_t> frame = std::nullopt) const;

 private:
  /// Of many samples the one whose rays and tests a path are most nearly those of the frame.
  template <class Draw>
  shading::PathSample most_like(const PieceWork& work, const Draw& draw, std::uint64_t first = 0) const;
  void draw_sample(const Prepared& prepared, const Config& config, const shading::FirstHits* first_hits);
  static std::uint64_t strata_of(const Config& config, std::uint64_t rays);
  /// One path in `one_in`, evenly over the frame.
  shading::PathSample spread(std::uint64_t one_in, std::uint64_t seed) const;

  std::optional<double> raster_seconds_, draw_seconds_;
  shading::FirstHits first_hits_;                // result of the raster pass, which the tracer reads
  std::unique_ptr<shading::PathTracer> tracer_;  // one of these three is set
  std::unique_ptr<RayListWorkload> list_;
  std::unique_ptr<OwnRays> own_;
  std::optional<shading::PathSample> drawn_, share_;
  ringbus::Transport* ranks_ = nullptr;
  std::uint64_t frame_rays_, seed_;
  float exposure_;
  std::vector<PictureFile> files_;
  shading::PixelOrder order_;
};

}  // namespace carousel::app
