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

/// Linear RGB, as a film gives it.
using Picture = std::vector<float>;

/// A path-traced frame with the structure's levels, depth-first. Appends every ray to `rows` unless it is null.
Picture render(const scene::Scene& scene, const Config& config, const accel::Accel& accel,
               std::vector<report::HitRow>* rows = nullptr);

/// The same with exact hits. Rays leave surfaces as `config` says.
Picture render_exact(const scene::Scene& scene, const Config& config, const accel::ExactReference& reference);

report::PictureErrors compare(const Picture& picture, const Picture& exact);

/// RMSE of what a screen shows, values in [0, 1], without the 2 % that are farthest off: a few paths that are far too
/// bright would be all that counts, in the truth as well.
double noise(const Picture& picture, const Picture& truth);

/// Of `rows` as render() gives them: rays that left a triangle, and those of them that hit it again, which a flat
/// triangle never is.
struct SelfHits {
  std::uint64_t bounces = 0, self_hits = 0;
};
SelfHits count_self_hits(std::vector<report::HitRow> rows);

}  // namespace carousel::app
