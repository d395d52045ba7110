#include "bench/rays/summary_tables.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/rays/contestants.h"
#include "bench/rays/tables.h"

namespace carousel::bench {

std::string summary_table(const std::vector<SceneResult>& scenes) {
  const std::string local = kTreeletLocal, owners = kTreeletOwners, statistics = ", statistics";
  Table table({"ratio", "depth-first / Embree robust", "ring local / depth-first", "ring 2 owners / depth-first",
               "the same, 2 threads", "depth-first, 2 threads / 1", "ring local, 2 / 1", "ring 2 owners, 2 / 1",
               "with statistics, local", "2 owners"});
  for (const SceneResult& scene : scenes) {
    for (const SetResult& set : scene.sets) {
      const auto cpu = [&](const std::string& a, const std::string& b, int threads) {
        return ratio_text(cpu_rate(set, a, threads), cpu_rate(set, b, threads));
      };
      const auto scaling = [&](const std::string& a) { return ratio_text(wall_rate(set, a, 2), wall_rate(set, a, 1)); };
      table.add({scene.name + ", " + set.name, cpu(kDepthFirst, kEmbreeRobust, 1), cpu(local, kDepthFirst, 1),
                 cpu(owners, kDepthFirst, 1), cpu(owners, kDepthFirst, 2), scaling(kDepthFirst), scaling(local),
                 scaling(owners), cpu(local + statistics, local, 1), cpu(owners + statistics, owners, 1)});
    }
  }
  return table.text();
}

std::string machine_text(const BenchResult& result) {
  const MachineInfo& m = result.machine;
  std::string text = fmt::format(
      "- Machine: {}, {} hardware threads, {}; SIMD target {}\n"
      "- Commit {}, {}, {}; Embree {}\n"
      "- Measured {}; {} interleaved repetitions\n",
      m.cpu, m.threads, m.caches, m.simd, m.commit, m.compiler, m.build_type, m.embree, m.date, result.repetitions);
  std::string settings;
  for (const auto& [key, value] : result.settings) settings += (settings.empty() ? "" : ", ") + key + " " + value;
  return text + "- Settings: " + settings + "\n";
}

std::string micro_table(const std::string& benchmark_json) {
  const nlohmann::json json = nlohmann::json::parse(benchmark_json);
  Table table({"benchmark", "ns an item", "million items/s"});
  for (const nlohmann::json& one : json.at("benchmarks")) {
    const bool aggregate = one.at("run_type") == "aggregate";
    if (aggregate && one.at("aggregate_name") != "median") continue;
    const double items = one.value("items_per_second", 0.0);
    if (items <= 0) continue;
    table.add({one.at("run_name").get<std::string>(), fmt::format("{:.2f}", 1e9 / items),
               fmt::format("{:.1f}", 1e-6 * items)});
  }
  return table.text();
}

}  // namespace carousel::bench
