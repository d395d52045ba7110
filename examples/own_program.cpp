// A program of one's own that links the libraries: it configures a machine in C++, without a file, gives it a workload
// of its own, and uses what comes back.
#include <cstddef>
#include <cstdio>

#include <glm/geometric.hpp>

#include "accel/builders/build.h"
#include "core/config/config.h"
#include "core/system/executor.h"
#include "ringbus/cycle/cycle_engine.h"
#include "scanner.h"
#include "scene/builtin/builtin.h"

using namespace carousel;

int main() {
  const scene::Scene scene = scene::make_cornell();
  Config config;
  config.engine.kind = EngineKind::kCycle;
  config.topology.resources = 4;
  config.topology.link.bytes_per_cycle = 16;
  const accel::Accel accel = accel::build(scene, config.bvh, *make_sequential_executor());
  const Aabb box = scene.bounds();

  scanner::Scanner scanner(0.5f * (box.lo + box.hi), 2000);
  const ringbus::RunResult result =
      ringbus::run_cycle(config, accel, glm::length(box.hi - box.lo), scanner, ringbus::RunOptions{});

  std::size_t met = 0;
  double sum = 0;
  for (const float t : scanner.distances()) {
    if (t == kInfinity) continue;
    ++met;
    sum += t;
  }
  std::printf("%llu rays in %llu cycles\n", static_cast<unsigned long long>(result.rays_completed),
              static_cast<unsigned long long>(result.cycle->cycles));
  std::printf("%zu of 2000 beams met a surface, %.3f away on average\n", met, met > 0 ? sum / double(met) : 0);
  return met > 0 && result.rays_completed == 2000 + met ? 0 : 1;
}
