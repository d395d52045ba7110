#pragma once

#include <cstdint>
#include <vector>

#include "accel/structure/accel.h"
#include "accel/traverse/exact_reference.h"
#include "core/config/config.h"
#include "report/accuracy/accuracy.h"
#include "report/csv/ray_csv.h"
#include "scene/model/scene.h"

namespace carousel::app {

/// Linear RGB, as Film::linear_rgb() returns it.
using Picture = std::vector<float>;

/// A path-traced frame with the structure's levels, depth-first. Appends every ray to `rows` unless it is null.
Picture render(const scene::Scene& scene, const Config& config, const accel::Accel& accel,
               std::vector<report::HitRow>* rows = nullptr);

/// A path-traced frame with exact hits. `config` says where rays leave surfaces.
Picture render_exact(const scene::Scene& scene, const Config& config, const accel::ExactReference& reference);

report::PictureErrors compare(const Picture& picture, const Picture& exact);

/// RMSE of the displayed values, in [0, 1], without the 2 % with the largest errors: otherwise a few paths that are far
/// too bright, in the reference picture too, would decide the result.
double noise(const Picture& picture, const Picture& truth);

/// Counts in `rows` as render() returns them: rays that left a triangle, and rays that hit the same triangle again,
/// which is impossible for a flat triangle. Rays that leave a sphere are not counted: one that goes through it meets it
/// again.
struct SelfHits {
  std::uint64_t bounces = 0, self_hits = 0;
};
SelfHits count_self_hits(const scene::Scene& scene, std::vector<report::HitRow> rows);

}  // namespace carousel::app
