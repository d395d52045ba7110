#include "ringbus/cycle/bottleneck_search.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "ringbus/cycle/cycle_engine.h"
#include "ringbus/cycle/foretell.h"
#include "ringbus/cycle/steady_state.h"
#include "ringbus/cycle/what_if.h"

namespace carousel::ringbus {

namespace {

std::uint64_t slots_of(const Config& config) {
  return static_cast<std::uint64_t>(config.topology.resources * config.rays.slots_per_resource);
}

double rays_per_kilocycle(std::uint64_t rays, double cycles) {
  return 1000 * static_cast<double>(rays) / std::max(1.0, cycles);
}

class Search {
 public:
  Search(const Config& config, const accel::Accel& accel, float scene_size, const PilotFactory& make_pilot,
         const SearchedRun& run, const RunOptions& options, const SearchObserver& observe)
      : config_(config),
        accel_(accel),
        scene_size_(scene_size),
        make_pilot_(make_pilot),
        run_(run),
        options_(options),
        observe_(observe) {
    // The bottleneck is that of the whole machine, before a resource stops.
    stops_ = config_.faults.resource.kind == FaultsConfig::Resource::Kind::kStop;
    if (stops_) config_.faults.resource = {};
    what_ifs_ = what_ifs(config_, accel_);
    state_.of = what_ifs_.size() + 1;
  }

  Bottleneck search() {
    const std::uint64_t frame = run_.result.rays_completed;
    out_.paths = pilot_paths(config_, run_.paths, frame, what_ifs_.size() + 1);
    for (int doubled = 0;; ++doubled) {
      simulate_base();
      if (!out_.complete) return out_;
      const Foretelling foretelling({&*base_.cycle, base_.rays_completed}, frame, 2 * fill_rays(slots_of(config_)));
      judge(foretelling);
      if (out_.unlike.empty()) {
        lift_all(foretelling);
        return out_;
      }
      if (doubled == kDoublings) return out_;
      out_.paths = std::min(run_.paths, 2 * out_.paths);
    }
  }

 private:
  static constexpr int kDoublings = 2;

  RunResult simulate(const Config& machine) {
    const std::unique_ptr<Workload> pilot = make_pilot_(machine, out_.paths);
    RunOptions options = options_;
    // Each first miss of the frame's run would otherwise be one of the pilot, which has fewer rays to share it.
    options.warm = {&run_.result.cycle->cached_lines,
                    1 - static_cast<double>(out_.paths) / static_cast<double>(run_.paths)};
    options.progress = [&](std::uint64_t completed) {
      state_.completed = completed;
      if (observe_) observe_(state_);
    };
    options.progress(0);
    RunResult result = run_cycle(machine, accel_, scene_size_, *pilot, options);
    out_.complete &= result.complete;
    ++state_.done;
    return result;
  }

  /// The run itself is the pilot if that is the whole frame.
  void simulate_base() {
    out_.whole = out_.paths >= run_.paths;
    state_.done = 0;
    state_.rays = run_.result.rays_completed * out_.paths / std::max<std::uint64_t>(1, run_.paths);
    if (out_.whole && !stops_) {
      base_ = run_.result;
      ++state_.done;
    } else {
      base_ = simulate(config_);
    }
    out_.rays = base_.rays_completed;
  }

  /// Compares the pilot's cycles and busy times, as foretold for the frame, with those of the run.
  void judge(const Foretelling& foretelling) {
    // Schedules differ by so much for no reason that the pilot could know.
    constexpr double kTolerance = 0.02, kBusyTolerance = 0.05;
    const Estimate cycles = foretelling.cycles();
    out_.uncertainty = (cycles.high - cycles.value) / cycles.value;
    out_.unlike.clear();
    if (stops_) {
      out_.rays_per_kilocycle = rays_per_kilocycle(run_.result.rays_completed, cycles.value);
      return;
    }
    const double ran = static_cast<double>(run_.result.cycle->cycles), allowed = out_.uncertainty + kTolerance;
    out_.rays_per_kilocycle = rays_per_kilocycle(run_.result.rays_completed, ran);
    out_.deviation = ran / cycles.value - 1;
    if (std::abs(out_.deviation) > allowed) {
      out_.unlike = fmt::format("it foretells {:.0f} cycles for the frame, {:+.1f} % of the run's", cycles.value,
                                100 * (cycles.value / ran - 1));
      return;
    }
    const std::vector<double> busy = foretelling.busy();
    for (std::size_t i = 0; i < busy.size(); ++i) {
      const cycle::ClassUse& use = run_.result.cycle->uses[i];
      if (use.parts <= 0) continue;
      const double here = busy[i] / use.parts / cycles.value, there = static_cast<double>(use.busy) / use.parts / ran;
      if (std::abs(here - there) <= std::max(here, there) * out_.uncertainty + kBusyTolerance) continue;
      out_.unlike = fmt::format("{} are busy {:.0f} % of its time, and {:.0f} % of the run's", use.name, 100 * here,
                                100 * there);
      return;
    }
  }

  void lift_all(const Foretelling& foretelling) {
    for (const WhatIf& what_if : what_ifs_) {
      state_.name = what_if.name;
      const RunResult result = simulate(what_if.relaxed);
      if (!out_.complete) {
        out_.gains.clear();
        return;
      }
      const Estimate gain = foretelling.gain({&*result.cycle, result.rays_completed}, out_.deviation);
      out_.gains.push_back({what_if.name, what_if.action, what_if.sets, out_.rays_per_kilocycle * (1 + gain.value),
                            gain.value, gain.low, gain.high});
    }
    std::stable_sort(out_.gains.begin(), out_.gains.end(), [](const Gain& a, const Gain& b) { return a.gain > b.gain; });
  }

  Config config_;
  const accel::Accel& accel_;
  float scene_size_;
  const PilotFactory& make_pilot_;
  const SearchedRun& run_;
  const RunOptions& options_;
  const SearchObserver& observe_;
  bool stops_ = false;
  std::vector<WhatIf> what_ifs_;
  RunResult base_;
  SearchProgress state_;
  Bottleneck out_;
};

}  // namespace

std::uint64_t pilot_paths(const Config& config, std::uint64_t paths, std::uint64_t rays, std::size_t simulations) {
  // Four times the rays that fill a machine with twice the slots: most of the pilot is then between fill and drain,
  // and caches are warm for most of it.
  constexpr std::uint64_t kFills = 4, kLeastRays = 4000, kMostFills = 4 * kFills;
  const std::uint64_t fill = 2 * fill_rays(slots_of(config));
  const double rays_each = static_cast<double>(std::max(rays, paths)) / static_cast<double>(std::max<std::uint64_t>(1, paths));
  const std::uint64_t least = std::max(kLeastRays, kFills * fill), most = std::max(10 * kLeastRays, kMostFills * fill);
  const std::uint64_t wanted = std::clamp(rays / simulations, least, most);
  const auto pilot = static_cast<std::uint64_t>(std::ceil(static_cast<double>(wanted) / rays_each));
  // A pilot of most of the frame spares little, and the frame leaves no question.
  return 3 * pilot >= 2 * paths ? paths : pilot;
}

Bottleneck find_bottleneck(const Config& config, const accel::Accel& accel, float scene_size,
                           const PilotFactory& make_pilot, const SearchedRun& run, const RunOptions& options,
                           const SearchObserver& observe) {
  return Search(config, accel, scene_size, make_pilot, run, options, observe).search();
}

}  // namespace carousel::ringbus
