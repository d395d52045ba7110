#pragma once

#include <array>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "accel/structure/accel.h"
#include "bench/common/results.h"
#include "bench/common/stopwatch.h"
#include "core/config/config.h"
#include "scene/model/scene.h"

namespace carousel::bench {

/// The ways to shade a frame.
enum class Shading {
  kAuto,     ///< by the effects plan
  kAll,      ///< nothing is specialised
  kMinimal,  ///< code for plain surfaces and emissive lights alone
};

/// The cost of a frame, on one thread with the depth-first tracer.
struct FrameCost {
  std::string name;
  Spread frame_seconds;  ///< CPU time, tracing and shading
  Spread shade_seconds;  ///< wall time in shade() alone
  std::array<std::uint64_t, kRayKinds> rays{};
  std::uint64_t box_tests = 0, triangle_tests = 0;
  std::uint32_t path_state_bytes = 0;
  std::string image;  ///< digest
};

struct EffectsScene {
  std::string name;
  std::vector<FrameCost> costs;
};

/// Runs every way of shading once, then all of them again, so that other load of the machine affects all alike. Throws
/// WrongImage unless all pictures are the same. Precondition for kMinimal: the scene's materials are all plain.
EffectsScene measure_effects(const std::string& name, const scene::Scene& scene, const accel::Accel& accel,
                             const Config& config, const std::vector<Shading>& ways, int repetitions);

class WrongImage : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct EffectsBenchResult {
  MachineInfo machine;
  int repetitions = 0;
  std::vector<EffectsScene> scenes;
};
std::string to_json_text(const EffectsBenchResult& result);

}  // namespace carousel::bench
