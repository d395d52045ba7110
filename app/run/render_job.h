#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "app/run/prepare.h"
#include "app/run/ray_list_workload.h"
#include "report/run/report.h"
#include "shading/raster/first_hits.h"
#include "shading/tracer/path_tracer.h"

namespace carousel::app {

/// The rays of a run, whichever the configuration asks for: a picture's or a file's.
class RenderJob {
 public:
  /// Reads the file of `rays_from`. Keeps references to `prepared`. Throws ConfigError and FileError.
  explicit RenderJob(const Prepared& prepared) : RenderJob(prepared, prepared.config()) {}
  /// With another machine than the prepared one, for what-if runs. `first_hits`, if not null, are taken instead of a
  /// raster pass of its own, and must outlive the frame.
  RenderJob(const Prepared& prepared, const Config& config, const shading::FirstHits* first_hits = nullptr);

  Workload& workload() const;
  void set_recorder(shading::RayRecorder* recorder);
  /// Rays that no other ray causes: what the progress is measured by.
  std::uint64_t first_rays() const;

  /// Of the raster pass; null when rays find the first hits.
  const shading::FirstHits* first_hits() const { return raster_seconds_ ? &first_hits_ : nullptr; }

  // Results, for when the workers are joined.

  std::array<std::uint64_t, kRayKinds> emitted() const;  ///< by RayKind
  std::uint64_t saturated() const;
  std::string hits_digest() const;
  /// Absent when the rays make no picture.
  std::optional<std::string> image_digest() const;
  /// What the rasteriser did, and how long it took; absent when rays found the first hits.
  std::optional<RasterCounts> raster() const;
  std::optional<double> raster_seconds() const { return raster_seconds_; }
  /// image.png and image.exr, if there is a picture.
  void write_images(const std::filesystem::path& folder) const;

 private:
  std::optional<double> raster_seconds_;
  shading::FirstHits first_hits_;                // of the raster pass; the tracer reads them
  std::unique_ptr<shading::PathTracer> tracer_;  // one of the two
  std::unique_ptr<RayListWorkload> list_;
  std::uint64_t first_rays_;
};

}  // namespace carousel::app
