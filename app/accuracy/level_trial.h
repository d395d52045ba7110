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

/// A scene's structures for all levels: built once a transform level, the other levels being a matter of the tests.
class LevelledAccel {
 public:
  LevelledAccel(const scene::Scene& scene, const BvhConfig& bvh) : scene_(scene), bvh_(bvh) {}
  const accel::Accel& at(const AccuracyConfig& levels);

 private:
  const scene::Scene& scene_;
  BvhConfig bvh_;
  std::map<TransformLevel, accel::Accel> built_;
};

/// CPU time a ray, nanoseconds on one thread, of each of `levels`: all of them in turn, `repetitions` times, each round
/// starting with another one, so that whatever else the machine does meets all alike. `stopped` is asked in between.
std::vector<report::Spread> time_levels(LevelledAccel& accel, const std::vector<AccuracyConfig>& levels,
                                        const RayBatch& rays, int repetitions, const std::function<bool()>& stopped);

/// None if the cycle engine has not the configured machine.
std::optional<report::ModelledCost> modelled_cost(const Config& config, const accel::Accel& accel, float scene_size,
                                                  const RayBatch& rays);

}  // namespace carousel::app
