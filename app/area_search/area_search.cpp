#include "app/area_search/area_search.h"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "app/area/area_split.h"
#include "app/area/machine_area.h"
#include "app/build_report/experiment.h"
#include "app/host/log.h"
#include "app/run/render_job.h"
#include "core/config/load/validate.h"
#include "core/system/error.h"
#include "report/text/progress_line.h"
#include "report/text/ratio.h"
#include "ringbus/results/run_features.h"

namespace carousel::app {

namespace {

constexpr std::size_t kMostTrials = 40;
/// Of larger frames a part is simulated. A sample of a few times what the ray slots hold is mostly fill and drain, and
/// would choose wrongly (docs/how-it-works/machines.md).
constexpr double kPathsOfATrial = 200'000;

/// What a run asks for beside its machine is not asked of a trial.
void leave_machine(Config& c) {
  c.engine.what_if = false;
  c.verify = Verify::kNone;
  c.faults.compare = false;
}

class Search {
 public:
  Search(Prepared& prepared, const LocatedConfig& given, const InterruptScope& interrupt, bool quiet)
      : p_(prepared), given_(given), scene_(ringbus::scene_facts(prepared.accel)), interrupt_(interrupt) {
    out_.budget_mm2 = static_cast<double>(*given.config.area.budget_mm2);
    out_.fraction = fraction();
    out_.aim = enum_name(given.config.area.aim);
    if (!quiet) line_.emplace(stderr);
  }

  report::AreaSearch take() {
    Phase phase("area");
    AreaSplit best;
    if (!cost_of(best)) fit_area(p_.located = given_, scene_);  // there is no machine, and this says why
    out_.ended =
        fmt::format("no neighbour of the chosen split {}", out_.for_joules() ? "takes fewer joules" : "is faster");
    while (const std::optional<AreaSplit> next = better_neighbour(best)) best = *next;
    if (out_.fraction < own_fraction()) best = better_in_the_frame();
    const std::size_t chosen = trial_of_.at(best);
    out_.trials[chosen].chosen = true;
    set_machine(p_, located(*machine_of(given_, scene_, best)));
    phase.result(
        fmt::format("{} splits tried, the best has {} resources", out_.trials.size(), out_.trials[chosen].resources));
    return std::move(out_);
  }

 private:
  double own_fraction() const { return given_.config.sampling.fraction; }

  /// The part of the frame that a trial simulates: the whole of a small one, and where frames cannot be sampled.
  double fraction() const {
    Config c = given_.config;
    c.area.fit = AreaConfig::Fit::kRefuse;
    const double all = own_fraction(), paths = static_cast<double>(c.image.width * c.image.height * c.image.samples);
    if (c.workload.kind != WorkloadConfig::Kind::kRays || paths * all <= kPathsOfATrial) return all;
    c.sampling.fraction = kPathsOfATrial / paths;
    leave_machine(c);
    return validate_config(c, given_.positions, {.force = true}).empty() ? c.sampling.fraction : all;
  }

  LocatedConfig located(const Config& config) const {
    LocatedConfig out = given_;
    out.config = config;
    return out;
  }

  double cost_of(std::size_t trial) const { return out_.cost(out_.trials[trial]); }

  /// Returns the foretold cycles or joules of a split, of which the best has least; none if there is no such machine.
  std::optional<double> cost_of(const AreaSplit& split) {
    if (const auto known = trial_of_.find(split); known != trial_of_.end()) return cost_of(known->second);
    if (impossible_.contains(split)) return std::nullopt;
    std::optional<Config> machine = machine_of(given_, scene_, split);
    if (!machine || !holds(*machine, out_.fraction)) {
      impossible_.insert(split);
      return std::nullopt;
    }
    trial_of_.emplace(split, out_.trials.size());
    out_.trials.push_back(simulate(*machine));
    return cost_of(out_.trials.size() - 1);
  }

  /// Gives the scene this machine, for a part of the frame; false if it does not hold it.
  bool holds(Config machine, double fraction) {
    leave_machine(machine);
    machine.sampling.fraction = fraction;
    try {
      set_machine(p_, located(machine));
    } catch (const ConfigError&) {
      if (out_.trials.empty()) throw;
      return false;
    }
    return true;
  }

  /// Runs the machine that the scene has.
  report::Report run() {
    if (line_)
      line_->update(static_cast<double>(out_.trials.size()) / kMostTrials, out_.trials.size(), "splits",
                    fmt::format("area, {} resources", p_.config().topology.resources));
    RenderJob job(p_);
    report::Report r = run_rays({}, p_, job, interrupt_, true);
    if (r.incomplete) throw Interrupted("the splits of the area had not all been simulated");
    return r;
  }

  static double cycles_of(const report::Report& r) {
    return r.sampled ? r.sampled->cycles.estimate : static_cast<double>(*r.engine.cycles);
  }

  static double nj_per_ray_of(const report::Report& r) {
    return r.sampled ? r.sampled->nj_per_ray->estimate : r.energy->nj_per_ray;
  }

  report::AreaTrial simulate(const Config& machine) {
    const report::Report r = run();
    report::AreaTrial out;
    out.resources = static_cast<std::uint64_t>(machine.topology.resources);
    for (const auto [kind, units] : machine.testers.units)
      if (has_units(machine, scene_, kind)) out.testers += static_cast<std::uint64_t>(units.units);
    out.l2_kib = static_cast<std::uint64_t>(machine.memory.l2_kib);
    out.l2_lines_per_cycle = static_cast<std::uint64_t>(machine.memory.l2_lines_per_cycle);
    out.shader_workers = static_cast<std::uint64_t>(shader_workers(machine));
    out.mm2 = r.area->mm2;
    out.cycles = cycles_of(r);
    out.nj_per_ray = nj_per_ray_of(r);
    return out;
  }

  /// Simulates the two best splits once more, on the frame of the run, and returns the better one: samples may have
  /// their order wrong.
  AreaSplit better_in_the_frame() {
    std::vector<AreaSplit> splits(out_.trials.size());
    for (const auto& [split, trial] : trial_of_) splits[trial] = split;
    const auto foretold = [&](const AreaSplit& split) { return cost_of(trial_of_.at(split)); };
    std::stable_sort(splits.begin(), splits.end(),
                     [&](const AreaSplit& a, const AreaSplit& b) { return foretold(a) < foretold(b); });
    AreaSplit best = splits.front();
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < std::min<std::size_t>(2, splits.size()); ++i) {
      if (!holds(*machine_of(given_, scene_, splits[i]), own_fraction())) continue;
      const report::Report r = run();
      const double cycles = cycles_of(r), nj_per_ray = nj_per_ray_of(r), cost = out_.for_joules() ? nj_per_ray : cycles;
      report::AreaTrial& trial = out_.trials[trial_of_.at(splits[i])];
      trial.frame_cycles = cycles;
      trial.frame_nj_per_ray = nj_per_ray;
      if (cost < least) {
        least = cost;
        best = splits[i];
      }
    }
    return best;
  }

  /// The best neighbour, if it is better. Of equal ones the first that was tried.
  std::optional<AreaSplit> better_neighbour(const AreaSplit& split) {
    std::optional<AreaSplit> best;
    double least = cost_of(trial_of_.at(split));
    for (std::size_t part = 0; part < AreaSplit::kParts; ++part) {
      for (const int by : {1, -1}) {
        AreaSplit next = split;
        next.steps[part] += by;
        if (out_.trials.size() == kMostTrials && !trial_of_.contains(next)) {
          out_.ended = fmt::format("{} splits had been tried", kMostTrials);
          continue;
        }
        if (const std::optional<double> cost = cost_of(next); cost && *cost < least) {
          least = *cost;
          best = next;
        }
      }
    }
    return best;
  }

  Prepared& p_;
  const LocatedConfig given_;
  SceneFacts scene_;
  const InterruptScope& interrupt_;
  report::AreaSearch out_;
  std::map<AreaSplit, std::size_t> trial_of_;
  std::set<AreaSplit> impossible_;
  std::optional<report::ProgressLine> line_;
};

}  // namespace

report::AreaSearch search_area(Prepared& prepared, const LocatedConfig& given, const InterruptScope& interrupt,
                               bool quiet) {
  return Search(prepared, given, interrupt, quiet).take();
}

}  // namespace carousel::app
