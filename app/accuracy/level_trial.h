#pragma once

#include <functional>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "accel/structure/accel.h"
#include "app/accuracy/hard_scenes.h"
#include "core/config/config.h"
#include "report/accuracy/accuracy.h"

namespace carousel::app {

/// True if the configured cull planes go with the level; with others they could lose hits (core/config/validate.cpp),
/// so these are tried without planes.
bool planes_fit(const Config& config, const AccuracyConfig& levels);

/// A scene's structures for all levels, built once for each transform level with and without planes; the other levels
/// change only the tests.
class LevelledAccel {
 public:
  /// `any_hit` answers any-hit calls; null where every material is opaque.
  LevelledAccel(const scene::Scene& scene, const Config& config, const BvhConfig& bvh, const AnyHit* any_hit)
      : scene_(scene), config_(config), bvh_(bvh), any_hit_(any_hit) {}
  /// Valid until the next call. `any_hit`, if not null, answers in place of the scene's own.
  const accel::Accel& at(const AccuracyConfig& levels, const AnyHit* any_hit = nullptr);

 private:
  const scene::Scene& scene_;
  const Config& config_;
  BvhConfig bvh_;
  const AnyHit* any_hit_;
  std::map<std::pair<TransformLevel, bool>, accel::Accel> built_;  // true: with planes
};

/// CPU time a ray, nanoseconds on one thread, of each of `levels`: all of them in turn, `repetitions` times. Each round
/// starts with another level, so that other load of the machine affects all alike. `stopped` is called in between.
std::vector<report::Spread> time_levels(LevelledAccel& accel, const std::vector<AccuracyConfig>& levels,
                                        const RayBatch& rays, int repetitions, const std::function<bool()>& stopped);

/// Simulates `machine` and the machine `relaxed` from it (ringbus/verdict/what_if.h, tester_limited()) at the levels of
/// `accel`, on each of some pictures' rays. Empty if the cycle engine does not support the configured machine.
std::optional<report::ModelledCost> modelled_cost(const Config& machine, const Config& relaxed,
                                                  const accel::Accel& accel, float scene_size,
                                                  const std::vector<RayBatch>& pictures);

}  // namespace carousel::app
