#include "app/run/bottleneck.h"

#include <algorithm>

#include <fmt/format.h>

#include "report/text/ratio.h"
#include "ringbus/cycle/what_if.h"

namespace carousel::app {

namespace {

// A gain below this is not worth a verdict.
constexpr double kWorthIt = 0.05;

/// The rays of a render job alone; their picture is thrown away.
class FrameWorkload final : public Workload {
 public:
  FrameWorkload(const Prepared& prepared, const Config& config, const shading::FirstHits* first_hits)
      : frame_(prepared, config, first_hits) {}
  std::uint32_t extra_effects(const RayResult& result) const override {
    return frame_.workload().extra_effects(result);
  }
  Generated generate(WorkerId worker, std::size_t max_rays, RayBatch& out) override {
    return frame_.workload().generate(worker, max_rays, out);
  }
  void shade(WorkerId worker, const HitBatch& completed, RayBatch& out) override {
    frame_.workload().shade(worker, completed, out);
  }

 private:
  RenderJob frame_;
};

std::string percent_text(double fraction) {
  return fmt::format("{:+.1f} %", 100 * fraction);
}

std::string verdict(const report::Bottleneck& b) {
  if (b.gains.empty()) return "not found out: the run was interrupted";
  const report::BottleneckGain& first = b.gains.front();
  if (b.limits.empty())
    return fmt::format("no class of parts limits it alone: the best lift, {}, gains {}", first.action,
                       percent_text(first.gain));
  std::string text = fmt::format("{}: {} gains {}", first.name, first.action, percent_text(first.gain));
  if (b.gains.size() > 1) text += fmt::format(", next is {} with {}", b.gains[1].name, percent_text(b.gains[1].gain));
  return text;
}

}  // namespace

report::Bottleneck find_bottleneck(const Prepared& prepared, const RenderJob& job, std::stop_token stop) {
  const Config& config = prepared.config();
  ringbus::RunOptions options;
  options.threads = prepared.threads;
  options.stop = std::move(stop);
  options.statistics = false;
  const ringbus::Bottleneck found = ringbus::find_bottleneck(
      config, prepared.accel, prepared.scene_size(),
      [&](const Config& machine) { return std::make_unique<FrameWorkload>(prepared, machine, job.first_hits()); },
      std::min(job.first_rays(), ringbus::pilot_paths(config)), options);
  report::Bottleneck out;
  out.rays_per_kilocycle = found.rays_per_kilocycle;
  out.noise = found.noise;
  out.paths = found.paths;
  for (const ringbus::Gain& gain : found.gains)
    out.gains.push_back({gain.name, gain.action, gain.rays_per_kilocycle, gain.gain});
  if (!out.gains.empty() && out.gains.front().gain >= kWorthIt) out.limits = out.gains.front().name;
  out.verdict = verdict(out);
  return out;
}

report::Bound bound_of(const Config& config, const ringbus::RunResult& result) {
  const ringbus::cycle::CycleResult& c = *result.cycle;
  const double rays = static_cast<double>(result.rays_completed);
  report::Bound out;
  const auto add = [&](const char* name, double parts, double busy) {
    if (busy <= 0 || parts <= 0) return;
    out.classes.push_back({name, 1000 * rays * parts / busy});
  };
  PerUnit<double> units{};
  double reads = 0, dispatch = 0, link = 0;
  for (const ringbus::cycle::TileResult& tile : c.tiles) {
    for (const auto [kind, use] : tile.units) units[kind] += static_cast<double>(use.busy);
    reads += static_cast<double>(tile.ray_reads.busy);
    dispatch += static_cast<double>(tile.dispatch.busy);
  }
  for (const ringbus::cycle::LinkUse& one : c.links) link += static_cast<double>(one.use.busy);
  const double tiles = static_cast<double>(c.tiles.size());
  for (const auto [kind, busy] : units) add(unit_row(kind).work, tiles, busy);
  add("ray_reads", tiles, reads);
  add("handling", tiles, dispatch);
  add("link_bandwidth", static_cast<double>(c.links.size()), link);
  add("memory_bandwidth", 1, static_cast<double>(c.memory_busy));
  add("shading", static_cast<double>(shader_workers(config)), static_cast<double>(c.shading_busy));
  std::stable_sort(out.classes.begin(), out.classes.end(),
                   [](const auto& a, const auto& b) { return a.rays_per_kilocycle < b.rays_per_kilocycle; });
  if (out.classes.empty()) return out;
  out.rays_per_kilocycle = out.classes.front().rays_per_kilocycle;
  out.reached = report::ratio(1000 * rays / static_cast<double>(c.cycles), out.rays_per_kilocycle);
  return out;
}

}  // namespace carousel::app
