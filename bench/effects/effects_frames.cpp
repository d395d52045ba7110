#include "bench/effects/effects_frames.h"

#include <chrono>
#include <memory>

#include "accel/traverse/reference_tracer.h"
#include "bench/common/result_json.h"
#include "shading/tracer/path_tracer-inl.h"

namespace carousel::bench {

namespace {

using shading::PathTracer;

class MinimalTracer final : public PathTracer {
 public:
  using PathTracer::PathTracer;
  void shade(WorkerId worker, const HitBatch& completed, RayBatch& out) override {
    shade_batch<false>(worker, completed, out,
                       [this](const RayResult& result, const shading::TrianglePoint& point, Worker& own, RayBatch& rays,
                              std::uint32_t& children) {
                         shade_surface<shading::SurfaceClass::kPlain, Lights::kEmissive>(result, point, own, rays,
                                                                                         children);
                       });
  }
};

/// Measures the time in shade().
class TimedWorkload final : public Workload {
 public:
  explicit TimedWorkload(Workload& inner) : inner_(inner) {}
  Generated generate(WorkerId worker, std::size_t max_rays, RayBatch& out) override {
    return inner_.generate(worker, max_rays, out);
  }
  void shade(WorkerId worker, const HitBatch& completed, RayBatch& out) override {
    const auto start = std::chrono::steady_clock::now();
    inner_.shade(worker, completed, out);
    seconds_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }
  double seconds() const { return seconds_; }

 private:
  Workload& inner_;
  double seconds_ = 0;
};

const char* name_of(Shading way) {
  switch (way) {
    case Shading::kAuto:
      return "auto";
    case Shading::kAll:
      return "all";
    case Shading::kMinimal:
      break;
  }
  return "minimal";
}

std::unique_ptr<PathTracer> tracer_for(Shading way, const scene::Scene& scene, Config config) {
  using Choice = ShadingConfig::Effects::Choice;
  config.shading.effects.choice = way == Shading::kAll ? Choice::kAll : Choice::kAuto;
  constexpr std::size_t kPaths = 65536;
  if (way == Shading::kMinimal) return std::make_unique<MinimalTracer>(scene, config, kPaths, 1);
  return std::make_unique<PathTracer>(scene, config, kPaths, 1);
}

}  // namespace

EffectsScene measure_effects(const std::string& name, const scene::Scene& scene, const accel::Accel& accel,
                             const Config& config, const std::vector<Shading>& ways, int repetitions) {
  EffectsScene out{name, {}};
  std::vector<std::vector<double>> frames(ways.size()), shades(ways.size());
  out.costs.resize(ways.size());
  for (int round = 0; round <= repetitions; ++round) {  // the first round warms up
    for (std::size_t i = 0; i < ways.size(); ++i) {
      const std::size_t w = (i + static_cast<std::size_t>(round)) % ways.size();
      const std::unique_ptr<PathTracer> tracer = tracer_for(ways[w], scene, config);
      TimedWorkload timed(*tracer);
      const Stopwatch watch;
      const accel::ReferenceRun run = accel::run_reference(accel, timed);
      const double seconds = watch.elapsed().cpu;
      if (round > 0) {
        frames[w].push_back(seconds);
        shades[w].push_back(timed.seconds());
        continue;
      }
      out.costs[w] = {name_of(ways[w]),
                      {},
                      {},
                      tracer->counts().emitted,
                      run.tests.box,
                      run.tests.triangle,
                      tracer->plan().path_state_bytes(),
                      tracer->image_digest()};
      if (out.costs[w].image != out.costs[0].image && w != 0 && i > 0 && !out.costs[0].image.empty())
        throw WrongImage(name + ": " + name_of(ways[w]) + " gives another picture");
    }
  }
  for (std::size_t w = 0; w < ways.size(); ++w) {
    out.costs[w].frame_seconds = spread_of(frames[w]);
    out.costs[w].shade_seconds = spread_of(shades[w]);
  }
  return out;
}

std::string to_json_text(const EffectsBenchResult& result) {
  using Json = nlohmann::ordered_json;
  Json scenes = Json::array();
  for (const EffectsScene& scene : result.scenes) {
    Json costs = Json::array();
    for (const FrameCost& c : scene.costs) {
      costs.push_back({{"effects", c.name},
                       {"frame_cpu_seconds", json_of(c.frame_seconds)},
                       {"shade_seconds", json_of(c.shade_seconds)},
                       {"rays", {{"camera", c.rays[0]}, {"bounce", c.rays[1]}, {"shadow", c.rays[2]}}},
                       {"box_tests", c.box_tests},
                       {"triangle_tests", c.triangle_tests},
                       {"path_state_bytes", c.path_state_bytes},
                       {"image", c.image}});
    }
    scenes.push_back({{"scene", scene.name}, {"costs", costs}});
  }
  return Json{{"machine", json_of(result.machine)}, {"repetitions", result.repetitions}, {"scenes", scenes}}.dump(2) +
         "\n";
}

}  // namespace carousel::bench
