// bench_rays: builds scenes, traces the same rays with every engine and traversal, checks every hit, and reports the
// speed.
#include <algorithm>
#include <cstdio>
#include <map>
#include <memory>

#include <fmt/format.h>

#include "accel/builders/build.h"
#include "bench/common/machine_info.h"
#include "bench/common/marked_file.h"
#include "bench/common/scenes.h"
#include "bench/rays/build_times.h"
#include "bench/rays/contestants.h"
#include "bench/rays/measure.h"
#include "bench/rays/options.h"
#include "bench/rays/summary_tables.h"
#include "bench/rays/tables.h"
#include "core/system/atomic_file.h"
#include "core/system/error.h"
#include "core/system/executor.h"

namespace carousel::bench {

namespace {

SceneResult run_scene(const SceneChoice& choice, const Options& options) {
  SceneResult result;
  result.name = choice.name();
  fmt::print(stderr, "{}\n", result.name);
  const scene::Scene scene = make_scene(choice);
  result.triangles = scene.unique_triangle_count();
  result.instances = scene.instances.size();
  const int most = *std::max_element(options.threads.begin(), options.threads.end());
  if (options.build) {
    const int repetitions = std::min(options.repetitions, 3);
    result.builds = build_times(scene, options.bvh, options.field, options.threads, repetitions);
    result.to_first_packet_seconds = to_first_packet(scene, options.bvh, options.ring, most, repetitions);
  }
  const auto executor = make_tbb_executor(static_cast<std::size_t>(most));
  const accel::Accel accel = accel::build(scene, options.bvh, *executor);
  const Contest contest(scene, accel, options.ring, options.field);
  MeasureOptions measure_options{options.repetitions, options.threads, {}};
  measure_options.progress = [](const std::string& text) { fmt::print(stderr, "  {}\n", text); };
  for (const RaySet& rays : make_ray_sets(scene, accel, options.image_side, options.seed)) {
    if (!options.sets.empty() && std::find(options.sets.begin(), options.sets.end(), rays.name) == options.sets.end())
      continue;
    result.sets.push_back(measure(contest.contestants(), accel, rays, measure_options));
    const SetResult& set = result.sets.back();
    fmt::print("\n{}: {} {} rays, {} hits, digest {}\n\n{}\n{}", result.name, set.rays, set.name, set.hits, set.digest,
               set_table(set), work_table(set));
    std::fflush(stdout);
  }
  return result;
}

BenchResult run_all(const Options& options) {
  BenchResult result;
  result.machine = machine_info();
  result.settings = options.describe();
  result.repetitions = options.repetitions;
  for (const SceneChoice& choice : choose_scenes(options.builtins, options.sizes, options.files))
    result.scenes.push_back(run_scene(choice, options));
  if (options.build) fmt::print("\n{}", build_table(result.scenes));
  fmt::print("\n{}\n{}", summary_table(result.scenes), machine_text(result));
  if (!options.json.empty()) write_file(options.json, to_json_text(result));
  return result;
}

std::string details(const std::vector<SceneResult>& scenes) {
  std::string text;
  for (const SceneResult& scene : scenes) {
    text += fmt::format("{}### {}\n\n{} triangles, {} instances.\n", text.empty() ? "" : "\n", scene.name,
                        scene.triangles, scene.instances);
    for (const SetResult& set : scene.sets)
      text += fmt::format("\n**{}**, {}: {} rays, {} hits.\n\n{}\n{}", set.name,
                          set.any_hit ? "any hit" : "closest hit", set.rays, set.hits, set_table(set), work_table(set));
  }
  return text;
}

void draw(const Options& options, const std::vector<BenchResult>& results) {
  std::vector<SceneResult> scenes;
  std::string machines;
  for (const BenchResult& result : results) {
    scenes.insert(scenes.end(), result.scenes.begin(), result.scenes.end());
    std::string names;
    for (const SceneResult& scene : result.scenes) names += (names.empty() ? "" : ", ") + scene.name;
    machines += fmt::format("{}{}:\n\n{}", machines.empty() ? "" : "\n", names, machine_text(result));
  }
  std::map<std::string, std::string> tables{{"machine", machines},
                                            {"summary", summary_table(scenes)},
                                            {"build", build_table(scenes)},
                                            {"details", details(scenes)}};
  if (!options.micro.empty()) tables["micro"] = micro_table(read_text(options.micro));
  replace_marked(options.markdown, tables);
}

int run(int argc, char** argv) {
  int exit_status = 0;
  const std::optional<Options> options = parse_options(argc, argv, exit_status);
  if (!options) return exit_status;
  std::vector<BenchResult> results;
  for (const std::string& file : options->from) results.push_back(from_json_text(read_text(file)));
  if (results.empty()) results.push_back(run_all(*options));
  if (!options->markdown.empty()) draw(*options, results);
  return 0;
}

}  // namespace

}  // namespace carousel::bench

int main(int argc, char** argv) {
  try {
    return carousel::bench::run(argc, argv);
  } catch (const carousel::ConfigError& error) {
    fmt::print(stderr, "bench_rays: {}\n", error.what());
    return 2;
  } catch (const carousel::SceneError& error) {
    fmt::print(stderr, "bench_rays: {}\n", error.what());
    return 2;
  } catch (const std::exception& error) {
    fmt::print(stderr, "bench_rays: {}\n", error.what());
    return 1;
  }
}
