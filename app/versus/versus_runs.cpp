#include "app/versus/versus_runs.h"

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/area/machine_area.h"
#include "app/area_search/area_search.h"
#include "app/build_report/build_report.h"
#include "app/run/bottleneck.h"
#include "app/run/render_job.h"
#include "app/versus/twin.h"
#include "core/config/differences.h"
#include "core/system/error.h"
#include "report/text/progress_line.h"
#include "report/text/ratio.h"
#include "ringbus/cycle/cycle_engine.h"
#include "ringbus/results/run_features.h"
#include "ringbus/verdict/what_if.h"

namespace carousel::app {

namespace {

using report::ratio;

/// The runs of one machine, and what its report says.
class VersusRuns {
 public:
  VersusRuns(Prepared& prepared, const VersusSettings& settings, const InterruptScope& interrupt)
      : p_(prepared), settings_(settings), interrupt_(interrupt), located_(prepared.located) {
    located_.config.engine.what_if = false;
    located_.config.area.budget_mm2.reset();  // the machine has been fitted
    located_.config.area.fit = AreaConfig{}.fit;
    located_.config.area.aim = AreaConfig{}.aim;
    located_.config.verify = Verify::kNone;
    if (located_.config.energy.profile == CostProfile::kNone) located_.config.energy.profile = CostProfile::kN45;
    if (!settings.quiet) line_.emplace(stderr);
  }

  report::Versus take() {
    report::Versus out;
    out.seeds = settings_.seeds;
    out.profile = enum_name(located_.config.energy.profile);
    const Config machine = located_.config;
    const Twin conventional = conventional_twin(located_);
    const Config& twin = conventional.config;
    if (!conventional.drawing.empty()) out.drawing = conventional.drawing;
    out.twin_sets = config_differences(machine, twin);
    add(out, "machine", machine);
    add(out, "twin", twin);
    add_at_equal_area(out, conventional.plain, out.machines.front().mm2);
    for (std::size_t i = 1; i < out.machines.size(); ++i) out.against.push_back(against(out, out.machines[i].name));
    if (settings_.search) turn_round(out, machine, twin);
    out.lines = report::versus_lines(out);
    return out;
  }

 private:
  LocatedConfig located(const Config& config) const {
    LocatedConfig out = located_;
    out.config = config;
    return out;
  }

  /// One frame. The report has no search for the bottleneck.
  report::Report run(const Config& config, const std::string& what) {
    set_machine(p_, located(config));
    if (line_) line_->update(done_ / (done_ + 4), static_cast<std::uint64_t>(done_), "frames", what);
    RenderJob job(p_);
    ringbus::RunOptions options;
    options.threads = p_.threads;
    options.stop = interrupt_.token();
    const ringbus::RunResult result =
        ringbus::run_cycle(p_.config(), p_.accel, p_.scene_size(), job.workload(), options);
    if (!result.complete) throw Interrupted("the machines had not all been simulated");
    ++done_;
    report::Report out = build_report(p_, job, result, nullptr);
    out.bound = bound_of(result);
    return out;
  }

  static double memory_bytes(const report::Report& r) {
    std::uint64_t bytes = 0;
    for (const ByteRow& row : *r.bytes)
      if (row.what == "lines" || row.what == "written lines") bytes += row.bytes;
    return ratio(bytes, r.rays.completed);
  }

  void add(report::Versus& out, const std::string& name, Config config) {
    report::VersusMachine machine{.name = name};
    std::vector<double> rates, bytes, joules;
    for (std::uint64_t i = 0; i < settings_.seeds; ++i) {
      config.image.seed = located_.config.image.seed + static_cast<std::int64_t>(i);
      const report::Report r = run(config, fmt::format("{}, seed {}", name, config.image.seed));
      report::VersusRun of{.machine = name,
                           .seed = static_cast<std::uint64_t>(config.image.seed),
                           .rays = r.rays.completed,
                           .cycles = *r.engine.cycles,
                           .rays_per_kilocycle = ratio(1000 * static_cast<double>(r.rays.completed),
                                                       static_cast<double>(*r.engine.cycles)),
                           .memory_bytes_per_ray = memory_bytes(r),
                           .nj_per_ray = r.energy->nj_per_ray,
                           .hits = r.digest.hits,
                           .nearest = r.nearest ? r.nearest->digest : "",
                           .image = r.digest.image.value_or("")};
      rates.push_back(of.rays_per_kilocycle);
      bytes.push_back(of.memory_bytes_per_ray);
      joules.push_back(of.nj_per_ray);
      require_same(out, of);
      out.runs.push_back(std::move(of));
      if (i == 0) describe_machine(machine, r);
    }
    machine.rays_per_kilocycle = report::versus_mean(rates);
    machine.memory_bytes_per_ray = report::versus_mean(bytes);
    machine.nj_per_ray = report::versus_mean(joules);
    out.machines.push_back(std::move(machine));
  }

  void describe_machine(report::VersusMachine& machine, const report::Report& r) const {
    machine.resources = static_cast<std::uint64_t>(ray_owners(p_.config().topology));  // as the twin has them
    machine.mm2 = r.area->mm2;
    if (!r.bound->classes.empty()) machine.limits = r.bound->classes.front().name;
    machine.reached = r.bound->reached;
    std::uint64_t lanes = 0, rays = 0;
    for (const report::Resource& resource : *r.resources)
      if (resource.units && resource.units->warps) {
        lanes += resource.units->warps->counts.lane_cycles;
        rays += resource.units->warps->counts.ray_cycles;
      }
    if (lanes > 0) machine.lane_fill = ratio(rays, lanes);
  }

  /// A machine changes neither hits nor picture.
  static void require_same(const report::Versus& out, const report::VersusRun& run) {
    for (const report::VersusRun& other : out.runs)
      if (other.seed == run.seed &&
          (other.hits != run.hits || other.nearest != run.nearest || other.image != run.image))
        throw SimulationError(
            fmt::format("hits or picture of {} and {} differ with seed {}", other.machine, run.machine, run.seed));
  }

  /// The twin that is as large as this machine; none if not even one resource is.
  void add_at_equal_area(report::Versus& out, Config twin, double mm2) {
    twin.area.budget_mm2 = static_cast<float>(mm2);
    twin.area.fit = settings_.best ? AreaConfig::Fit::kBest : AreaConfig::Fit::kAll;
    twin.area.aim = settings_.best.value_or(AreaConfig{}.aim);
    LocatedConfig fitted = located(twin);
    try {
      fit_area(fitted, ringbus::scene_facts(p_.accel));
    } catch (const ConfigError&) {
      return;
    }
    if (settings_.best) {
      out.twin_search = search_area(p_, fitted, interrupt_, settings_.quiet);
      fitted.config = p_.config();
    }
    fitted.config.area = twin.area;
    fitted.config.area.budget_mm2.reset();
    fitted.config.area.fit = AreaConfig{}.fit;
    fitted.config.area.aim = AreaConfig{}.aim;
    add(out, "twin_at_equal_area", fitted.config);
  }

  static std::vector<double> values(const report::Versus& out, const std::string& name,
                                    double report::VersusRun::*member) {
    std::vector<double> all;
    for (const report::VersusRun& run : out.runs)
      if (run.machine == name) all.push_back(run.*member);
    return all;
  }

  static report::VersusPair against(const report::Versus& out, const std::string& than) {
    const auto of = [&](double report::VersusRun::*member) {
      return report::versus_ratio(values(out, "machine", member), values(out, than, member));
    };
    report::VersusPair pair{.than = than,
                            .verdict = {},
                            .speed = of(&report::VersusRun::rays_per_kilocycle),
                            .bytes = of(&report::VersusRun::memory_bytes_per_ray),
                            .joules = of(&report::VersusRun::nj_per_ray)};
    pair.verdict = pair.speed.low ? "alike" : "unsure";
    if (pair.speed.surely_more()) pair.verdict = "faster";
    if (pair.speed.surely_less()) pair.verdict = "slower";
    return pair;
  }

  /// Relaxes each class of parts of the slower machine, with the first seed.
  void turn_round(report::Versus& out, const Config& machine, const Config& twin) {
    const bool slow = out.against.front().speed.ratio < 1;
    out.slower = slow ? "machine" : "twin";
    const double own = values(out, out.slower, &report::VersusRun::rays_per_kilocycle).front(),
                 other = values(out, slow ? "twin" : "machine", &report::VersusRun::rays_per_kilocycle).front();
    for (const ringbus::WhatIf& what_if : ringbus::what_ifs(slow ? machine : twin, p_.accel)) {
      const report::Report r = run(what_if.relaxed, fmt::format("the {} with {}", out.slower, what_if.part.action));
      const double rate = ratio(1000 * static_cast<double>(r.rays.completed), static_cast<double>(*r.engine.cycles));
      out.turns.push_back({what_if.name(), what_if.part.action, what_if.sets, rate / own - 1, rate / other});
    }
    std::stable_sort(out.turns.begin(), out.turns.end(), [](const auto& a, const auto& b) { return a.gain > b.gain; });
  }

  Prepared& p_;
  const VersusSettings& settings_;
  const InterruptScope& interrupt_;
  LocatedConfig located_;
  std::optional<report::ProgressLine> line_;
  double done_ = 0;
};

}  // namespace

report::Versus run_versus(Prepared& prepared, const VersusSettings& settings, const InterruptScope& interrupt) {
  return VersusRuns(prepared, settings, interrupt).take();
}

}  // namespace carousel::app
