#include "app/area_search/area_search.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <utility>

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
    if (!quiet) line_.emplace(stderr);
  }

  report::AreaSearch take() {
    Phase phase("area");
    AreaSplit best;
    if (!cycles_of(best)) fit_area(p_.located = given_, scene_);  // there is no machine, and this says why
    out_.ended = "no neighbour of the chosen split is faster";
    while (const std::optional<AreaSplit> next = faster_neighbour(best)) best = *next;
    const std::size_t chosen = trial_of_.at(best);
    out_.trials[chosen].chosen = true;
    set_machine(p_, located(*machine_of(given_, scene_, best)));
    phase.result(
        fmt::format("{} splits tried, the best has {} resources", out_.trials.size(), out_.trials[chosen].resources));
    return std::move(out_);
  }

 private:
  /// The part of the frame that a trial simulates: the whole of a small one, and where frames cannot be sampled.
  double fraction() const {
    Config c = given_.config;
    c.area.fit = AreaConfig::Fit::kRefuse;
    const double all = c.sampling.fraction,
                 paths = static_cast<double>(c.image.width * c.image.height * c.image.samples);
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

  /// The foretold cycles of a split; none if there is no such machine.
  std::optional<double> cycles_of(const AreaSplit& split) {
    if (const auto known = trial_of_.find(split); known != trial_of_.end()) return out_.trials[known->second].cycles;
    if (impossible_.contains(split)) return std::nullopt;
    std::optional<Config> machine = machine_of(given_, scene_, split);
    if (!machine || !holds(*machine)) {
      impossible_.insert(split);
      return std::nullopt;
    }
    trial_of_.emplace(split, out_.trials.size());
    out_.trials.push_back(simulate(*machine));
    return out_.trials.back().cycles;
  }

  /// Gives the scene this machine; false if it does not hold it.
  bool holds(Config machine) {
    leave_machine(machine);
    machine.sampling.fraction = out_.fraction;
    try {
      set_machine(p_, located(machine));
    } catch (const ConfigError&) {
      if (out_.trials.empty()) throw;
      return false;
    }
    return true;
  }

  report::AreaTrial simulate(const Config& machine) {
    if (line_)
      line_->update(static_cast<double>(out_.trials.size()) / kMostTrials, out_.trials.size(), "splits",
                    fmt::format("area, {} resources", machine.topology.resources));
    RenderJob job(p_);
    const report::Report r = run_rays({}, p_, job, interrupt_, true);
    if (r.incomplete) throw Interrupted("the splits of the area had not all been simulated");
    report::AreaTrial out;
    out.resources = static_cast<std::uint64_t>(machine.topology.resources);
    for (const auto [kind, units] : machine.testers.units)
      if (has_units(machine, scene_, kind)) out.testers += static_cast<std::uint64_t>(units.units);
    out.l2_kib = static_cast<std::uint64_t>(machine.memory.l2_kib);
    out.l2_lines_per_cycle = static_cast<std::uint64_t>(machine.memory.l2_lines_per_cycle);
    out.shader_workers = static_cast<std::uint64_t>(shader_workers(machine));
    out.mm2 = r.area->mm2;
    out.cycles = r.sampled ? r.sampled->cycles.estimate : static_cast<double>(*r.engine.cycles);
    return out;
  }

  /// The fastest neighbour, if it is faster. Of equal ones the first that was tried.
  std::optional<AreaSplit> faster_neighbour(const AreaSplit& split) {
    std::optional<AreaSplit> best;
    double least = out_.trials[trial_of_.at(split)].cycles;
    for (std::size_t part = 0; part < AreaSplit::kParts; ++part) {
      for (const int by : {1, -1}) {
        AreaSplit next = split;
        next.steps[part] += by;
        if (out_.trials.size() == kMostTrials && !trial_of_.contains(next)) {
          out_.ended = fmt::format("{} splits had been tried", kMostTrials);
          continue;
        }
        if (const std::optional<double> cycles = cycles_of(next); cycles && *cycles < least) {
          least = *cycles;
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
