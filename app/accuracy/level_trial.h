#pragma once

#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "accel/structure/accel.h"
#include "app/accuracy/hard_scenes.h"
#include "core/config/config.h"
#include "report/accuracy/accuracy.h"

namespace carousel::app {

/// A scene's structures for all levels, built once for each transform level; the other levels change only the tests.
class LevelledAccel {
 public:
  LevelledAccel(const scene::Scene& scene, const BvhConfig& bvh) : scene_(scene), bvh_(bvh) {}
  const accel::Accel& at(const AccuracyConfig& levels);

 private:
  const scene::Scene& scene_;
  BvhConfig bvh_;
  std::map<TransformLevel, accel::Accel> built_;
};

/// CPU time a ray, nanoseconds on one thread, of each of `levels`: all of them in turn, `repetitions` times. Each round
/// starts with another level, so that other load of the machine affects all alike. `stopped` is called in between.
std::vector<report::Spread> time_levels(LevelledAccel& accel, const std::vector<AccuracyConfig>& levels,
                                        const RayBatch& rays, int repetitions, const std::function<bool()>& stopped);

/// Empty if the cycle engine does not support the configured machine.
std::optional<report::ModelledCost> modelled_cost(const Config& config, const accel::Accel& accel, float scene_size,
                                                  const RayBatch& rays);

}  // namespace carousel::app
