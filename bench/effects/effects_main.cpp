// bench_effects: measures the time saved by shading only the effects that a scene calls for, and compares it with a
// program that has no others.
#include <cstdio>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "accel/builders/build.h"
#include "bench/common/machine_info.h"
#include "bench/common/scenes.h"
#include "bench/effects/effects_frames.h"
#include "core/system/atomic_file.h"
#include "core/system/executor.h"
#include "scene/builtin/builtin.h"
#include "shading/surface/alpha_test.h"

namespace carousel::bench {

namespace {

struct EffectsOptions {
  bool quick = false;
  int repetitions = 9;
  std::vector<std::string> files;
  std::string json;
};

EffectsScene run_scene(const EffectsOptions& o, const std::string& name, scene::Scene scene,
                       const std::vector<Shading>& ways) {
  fmt::print(stderr, "{}\n", name);
  accel::Accel accel = accel::build(scene, {}, *make_sequential_executor());
  const shading::AlphaTest alpha(scene);
  if (accel.has_non_opaque) accel.any_hit = &alpha;
  Config config;
  config.image = {o.quick ? 32 : 192, o.quick ? 32 : 192, 4, 5, 1};
  return measure_effects(name, scene, accel, config, ways, o.quick ? 1 : o.repetitions);
}

/// A scene of diffuse surfaces and one emissive quad.
scene::Scene diffuse_scene() {
  scene::Scene scene = scene::make_cornell();
  for (scene::Material& material : scene.materials) {
    material.metallic = 0;
    material.roughness = 1;
  }
  return scene;
}

void run(const EffectsOptions& o) {
  EffectsBenchResult result;
  result.machine = machine_info();
  result.repetitions = o.quick ? 1 : o.repetitions;
  const std::vector<Shading> two{Shading::kAuto, Shading::kAll};
  result.scenes.push_back(
      run_scene(o, "cornell, diffuse", diffuse_scene(), {Shading::kAuto, Shading::kMinimal, Shading::kAll}));
  for (const auto& choice : choose_scenes({"spheres", "terrain"}, {o.quick ? 2'000 : 50'000}, o.files))
    result.scenes.push_back(run_scene(o, choice.name(), make_scene(choice), two));
  fmt::print("{}", to_json_text(result));
  if (!o.json.empty()) write_file(o.json, to_json_text(result));
}

}  // namespace

}  // namespace carousel::bench

int main(int argc, char** argv) {
  carousel::bench::EffectsOptions o;
  CLI::App app("What shading only the effects a scene calls for saves", "bench_effects");
  app.add_flag("--quick", o.quick, "a smoke test: small pictures, one repetition");
  app.add_option("--repetitions", o.repetitions, "of each way of shading, in turn; one more warms up")
      ->check(CLI::Range(1, 1000));
  app.add_option("--file", o.files, "glTF files to measure as well");
  app.add_option("--json", o.json, "write the results here, too");
  CLI11_PARSE(app, argc, argv);
  try {
    carousel::bench::run(o);
  } catch (const std::exception& error) {
    fmt::print(stderr, "bench_effects: {}\n", error.what());
    return 1;
  }
}
