// bench_cycle: measures the speed of the cycle engine, on the network, the memory and rays, beside other simulators.
#include <cstdio>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "accel/builders/build.h"
#include "bench/common/machine_info.h"
#include "bench/common/scenes.h"
#include "bench/cycle/cycle_speed.h"
#include "bench/cycle/memory_speed.h"
#include "core/system/atomic_file.h"
#include "core/system/executor.h"

namespace carousel::bench {

namespace {

struct CycleOptions {
  bool quick = false, no_rays = false;
  int repetitions = 5;
  std::string json;
  std::string only;
};

void run(const CycleOptions& o) {
  CycleBenchResult result;
  result.machine = machine_info();
  result.repetitions = o.quick ? 1 : o.repetitions;
  const auto wanted = [&](const std::string& name) { return name.find(o.only) != std::string::npos; };
  for (const TrafficCase& one : traffic_cases(o.quick ? 20'000 : 1'000'000)) {
    if (!wanted(one.name)) continue;
    fmt::print(stderr, "traffic: {}\n", one.name);
    result.traffic.push_back(measure_traffic(one, result.repetitions));
  }
  for (const MemoryCase& one : memory_cases(o.quick ? 5'000 : 500'000)) {
    if (!wanted(one.name)) continue;
    fmt::print(stderr, "memory: {}\n", one.name);
    result.memory.push_back(measure_memory(one, result.repetitions));
  }
  if (!o.no_rays) {
    const scene::Scene scene = make_scene({"terrain", o.quick ? 5'000 : 100'000, {}});
    const accel::Accel accel = accel::build(scene, {}, *make_sequential_executor());
    const RaySet rays = primary_and_bounce(scene, accel, o.quick ? 48 : 256);
    for (const RayCase& one : ray_cases()) {
      if (!wanted(one.name)) continue;
      fmt::print(stderr, "rays: {}, {} threads\n", one.name, one.threads);
      result.rays.push_back(measure_rays(one, accel, glm::length(scene.bounds().extent()), rays, result.repetitions));
    }
  }
  fmt::print("{}", cycle_tables(result));
  if (!o.json.empty()) write_file(o.json, to_json_text(result));
}

}  // namespace

}  // namespace carousel::bench

int main(int argc, char** argv) {
  carousel::bench::CycleOptions o;
  CLI::App app("Speed of the cycle engine: synthetic traffic, memory alone, and rays through a whole machine",
               "bench_cycle");
  app.add_flag("--quick", o.quick, "a smoke test: few packets, few rays, one repetition");
  app.add_flag("--no-rays", o.no_rays, "traffic and memory only");
  app.add_option("--repetitions", o.repetitions, "of each case; tables show the median, least and greatest")
      ->check(CLI::Range(1, 100));
  app.add_option("--only", o.only, "only cases whose name holds this text");
  app.add_option("--json", o.json, "write the results here");
  CLI11_PARSE(app, argc, argv);
  try {
    carousel::bench::run(o);
  } catch (const std::exception& error) {
    fmt::print(stderr, "bench_cycle: {}\n", error.what());
    return 1;
  }
}
