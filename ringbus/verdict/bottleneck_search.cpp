#include "ringbus/verdict/bottleneck_search.h"

#include <algorithm>
#include <deque>
#include <limits>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include "core/numeric/worth_naming.h"
#include "ringbus/verdict/cold_caches.h"
#include "ringbus/verdict/foretell.h"
#include "ringbus/verdict/phases.h"
#include "ringbus/verdict/pilot_likeness.h"
#include "ringbus/verdict/pilot_runs.h"
#include "ringbus/verdict/search_choices.h"
#include "ringbus/verdict/steady_state.h"
#include "ringbus/verdict/what_if.h"

namespace carousel::ringbus {

namespace {

class Search {
 public:
  Search(const Config& config, const accel::Accel& accel, float scene_size, const PilotFactory& make_pilot,
         const SearchedRun& run, const RunOptions& options, const SearchObserver& observe)
      : config_(config),
        accel_(accel),
        run_(run),
        budget_{run.paths, run.result.rays_completed},
        pilots_(accel, scene_size, make_pilot, run, options, observe) {
    // The bottleneck is that of the whole machine, before a resource stops.
    stops_ = config_.faults.resource.kind == FaultsConfig::Resource::Kind::kStop;
    if (stops_) config_.faults.resource = {};
    noise_seeds_ = stops_ ? 0 : run.noise_seeds;  // the whole machine's noise is not that of a run in which one stops
    what_ifs_ = what_ifs(config_, accel_, &out_.untried);
    out_.gains.resize(what_ifs_.size());
    cold_ = cold(*run.result.cycle, slots_of(config_));
    fixed_work_ = work_is_fixed(config_, *run.result.cycle);
  }

  Bottleneck search() {
    std::vector<std::vector<std::size_t>> groups = first_groups();
    const std::size_t first = groups.size() + 1;
    out_.paths = first_paths(config_, run_.paths, budget_, first);
    if (budget_.of(out_.paths, first) > kAtMost) {
      out_.least_paths = least_frame(config_, run_, first);
      out_.gains.clear();
      return out_;
    }
    pilots_.begin("first pilot", first, out_.paths);
    screen(groups);
    note_phases();
    seeds_ = {out_.paths, draw_, base_.cycle ? static_cast<double>(base_.cycle->cycles) : 0};
    while (out_.complete && !told() && look_again()) continue;
    if (out_.complete) judge();
    if (out_.complete) find_noise();
    if (!out_.complete || !out_.unlike.empty()) {
      out_.gains.clear();
      out_.phases.clear();
    }
    std::stable_sort(out_.gains.begin(), out_.gains.end(), [](auto& a, auto& b) { return a.gain > b.gain; });
    return out_;
  }

  std::uint64_t least_paths() { return least_frame(config_, run_, first_groups().size() + 1); }

 private:
  /// The classes that are worth a simulation by the run's ledger.
  std::vector<std::vector<std::size_t>> first_groups() {
    std::vector<std::vector<std::size_t>> groups = search_groups(what_ifs_, *run_.result.cycle);
    for (std::size_t i = 0; i < what_ifs_.size(); ++i) note(i, {0, 0, most(i)}, 0);
    leave_out(groups, out_.gains, kWorthIt);
    return groups;
  }

  std::uint64_t frame() const { return run_.result.rays_completed; }

  /// So many simulations of the present pilot keep within this part of the run's rays.
  bool affords(std::size_t simulations, double part) const {
    return budget_.of(out_.paths, simulations) <= budget_.left(part, out_.simulated);
  }

  /// The most that a class may gain by the run's ledger, which is not that of a machine in which a resource stops.
  double most(std::size_t i) const {
    return stops_ ? std::numeric_limits<double>::infinity()
                  : most_gain(*run_.result.cycle, what_ifs_[i].name(), fixed_work_);
  }

  std::vector<RunResult> simulate(const std::vector<const Config*>& machines) {
    std::vector<RunResult> results = pilots_.simulate(machines);
    out_.complete &= pilots_.complete();
    out_.simulated = pilots_.simulated_rays();
    return results;
  }

  /// The run itself is the pilot if that is the whole frame. Returns true if nothing is left to simulate for it.
  bool base_is_the_run() {
    out_.whole = out_.paths >= run_.paths;
    if (!out_.whole || stops_) return false;
    set_base(run_.result);
    pilots_.leave_out_one();
    return true;
  }

  void set_base(RunResult base) {
    base_ = std::move(base);
    out_.rays = base_.rays_completed;
    if (out_.complete && !stops_) likeness_ = likeness(foretelling(base_), *run_.result.cycle);
  }

  /// Simulates the machine as configured. Draws the pilot again while it is not like the run, as long as that takes
  /// little beside the simulations that are to follow, and goes on with the one that is most like it.
  void simulate_base(std::size_t others) {
    if (base_is_the_run()) return;
    const std::uint64_t draws = cold_ ? 1 : 4;  // no part of a cold frame is like it
    constexpr double kLittle = 0.25;
    std::uint64_t taken = 0;
    for (std::uint64_t draw = 0; draw < draws; ++draw) {
      pilots_.take(draw);
      RunResult drawn = simulate({&config_}).front();
      if (!out_.complete) return;
      const double off = stops_ ? 0 : likeness(foretelling(drawn), *run_.result.cycle).off();
      if (draw == 0 || off < likeness_.off()) {
        taken = draw;
        set_base(std::move(drawn));
      }
      if (likeness_.off() <= kLike || budget_.of(out_.paths, draw + 2) > kLittle ||
          budget_.of(out_.paths, others + 1) > budget_.left(kWanted, out_.simulated))
        break;
      pilots_.expect_more(1);
    }
    draw_ = taken;
    pilots_.take(taken);
  }

  /// `more_slots`: for a machine with twice the ray slots, which is full later.
  Foretelling foretelling(const RunResult& base, bool more_slots = false) const {
    return {{&*base.cycle, base.rays_completed},
            frame(),
            (more_slots ? 2 : 1) * fill_rays(slots_of(config_)),
            stops_ ? nullptr : &*run_.result.cycle};
  }

  /// Simulates the pilot as configured and with each class that stands alone relaxed; then with those of each group
  /// relaxed together that may gain enough by the run's ledger; then parts of the groups for which that may gain
  /// enough, down to single classes, the most promising first, as far as the budget allows.
  void screen(std::vector<std::vector<std::size_t>> groups) {
    std::vector<std::vector<std::size_t>> later;
    for (const std::vector<std::size_t>& group : groups)
      if (group.size() > 1) later.push_back(group);
    std::erase_if(groups, [](const std::vector<std::size_t>& group) { return group.size() > 1; });
    simulate_base(groups.size() + later.size());
    double budget = kAtMost;
    for (int round = 0; out_.complete && !(groups.empty() && later.empty()); ++round) {
      std::vector<std::vector<std::size_t>> tried;
      std::deque<Config> together;
      std::vector<const Config*> machines;
      for (std::size_t k = 0; k < groups.size() && (round < 2 || affords(machines.size() + 1, budget)); ++k) {
        const std::vector<std::size_t> group = groups[k];
        std::vector<const WhatIf*> members;
        for (const std::size_t i : group) members.push_back(&what_ifs_[i]);
        std::optional<Config> machine =
            group.size() == 1 ? members.front()->relaxed : relaxed_together(config_, members);
        if (!machine) {
          divide(group, groups);
          continue;
        }
        machines.push_back(&together.emplace_back(std::move(*machine)));
        tried.push_back(group);
      }
      std::vector<RunResult> results = simulate(machines);
      if (!out_.complete) return;
      std::vector<std::pair<std::vector<std::size_t>, Estimate>> several;
      for (std::size_t k = 0; k < tried.size(); ++k) {
        const Estimate gain = gain_of(tried[k], results[k]);
        for (const std::size_t i : tried[k]) note(i, gain, tried[k].size());
        if (tried[k].size() > 1)
          several.emplace_back(std::move(tried[k]), gain);
        else
          relaxed_[tried[k].front()] = {std::move(results[k]), out_.paths};
      }
      // More of what stands idle costs nothing, so what all of them gain is at least what each does, but for chance.
      // A pilot that is not like the run, and may not even tell that from nothing, tells less of each.
      std::stable_sort(several.begin(), several.end(),
                       [](const auto& a, const auto& b) { return a.second.value > b.second.value; });
      // A group that gains more than any class that was looked at alone leaves nothing to name.
      budget = !several.empty() && several.front().second.value > greatest_alone(out_.gains) ? kAtMost : kWanted;
      if (cold_) budget = kWithFrame - 1.05;  // the frame may follow
      groups = std::exchange(later, {});
      for (const auto& [group, gain] : several)
        if (gain.value >= kEnough && (!likeness_.other_cycles || gain.low > 0)) divide(group, groups);
      leave_out(groups, out_.gains, std::max(kEnough, surely(out_.gains)));
    }
  }

  /// Where in the pilot which class limits, of those that were relaxed alone.
  void note_phases() {
    std::vector<std::size_t> classes;
    std::vector<PilotRun> runs;
    for (const auto& [i, relaxed] : relaxed_) {
      classes.push_back(i);
      runs.push_back({&*relaxed.result.cycle, relaxed.result.rays_completed});
    }
    if (!out_.complete) return;
    for (const FramePhase& phase : frame_phases({&*base_.cycle, base_.rays_completed}, runs)) {
      GainPhase& out = out_.phases.emplace_back(GainPhase{phase.begin, phase.end, phase.time, "", "", phase.gain});
      if (phase.best == kNoClass) continue;
      out.name = what_ifs_[classes[phase.best]].name();
      out.action = what_ifs_[classes[phase.best]].part.action;
    }
  }

  void divide(const std::vector<std::size_t>& group, std::vector<std::vector<std::size_t>>& parts) {
    const std::vector<std::vector<std::size_t>> own = parts_of(group);
    parts.insert(parts.end(), own.begin(), own.end());
    pilots_.expect_more(own.size());
  }

  /// Notes what a class gains that was relaxed with others, or with none, or was not simulated (0). Where a pilot gains
  /// more than the run may, the interval lies lower by that; and where it loses what more of a part hardly does, the
  /// interval's upper end is higher (gain_beyond()). What the whole frame gains is known.
  void note(std::size_t i, const Estimate& gain, std::size_t together) {
    const WhatIf& what = what_ifs_[i];
    const bool known = together == 1 && out_.whole;
    const double beyond = known || together == 0 ? 0 : gain_beyond(gain, what.name()),
                 high = known ? gain.high : std::min(gain.high + beyond, most(i)), value = std::min(gain.value, high),
                 low = gain.low - (gain.value - value);
    const double rate = rays_per_kilocycle(run_.result.rays_completed, static_cast<double>(run_.result.cycle->cycles));
    out_.gains[i] = {what.name(), what.part.action, what.sets, rate * (1 + value), value, low, high, together};
  }

  /// Relaxes each of these classes with the present pilot.
  void relax(const std::vector<std::size_t>& which) {
    std::vector<const Config*> machines;
    for (const std::size_t i : which) machines.push_back(&what_ifs_[i].relaxed);
    std::vector<RunResult> results = simulate(machines);
    if (!out_.complete) return;
    for (std::size_t k = 0; k < which.size(); ++k) relaxed_[which[k]] = {std::move(results[k]), out_.paths};
    estimate(which);
  }

  /// The gain of the machine with these classes relaxed, by the present pilot with what this is known to be off by.
  Estimate gain_of(const std::vector<std::size_t>& classes, const RunResult& relaxed) const {
    const auto any = [&](const auto& is) { return std::any_of(classes.begin(), classes.end(), is); };
    const bool slots = any([&](std::size_t i) { return what_ifs_[i].name() == "ray_slots"; }),
               warms = any([&](std::size_t i) { return what_ifs_[i].part.how.keeps_shapes; });
    // A pilot that was taken since it is like the run is less so in what was not compared.
    return foretelling(base_, slots)
        .gain({&*relaxed.cycle, relaxed.rays_completed}, std::max(kLike, likeness_.off()), warms);
  }

  /// Notes the gains of classes that were relaxed with the present pilot, with what this is known to be off by.
  void estimate(const std::vector<std::size_t>& classes) {
    for (const std::size_t i : classes) note(i, gain_of({i}, relaxed_[i].result), 1);
  }

  /// Simulates a larger pilot if it may tell more, and returns true then.
  bool look_again() {
    const bool of_memory = cold_ && !out_.unlike.empty();
    std::vector<std::size_t> worth =
        worth_a_second_look(out_.gains, of_memory || likeness_.other_cycles ? kFewest : kContenders, of_memory);
    const std::uint64_t paths = next_paths(worth);
    if (paths <= out_.paths && !(out_.whole && paths > 0)) return false;
    out_.paths = paths;
    pilots_.begin(paths < run_.paths ? "larger pilot" : "whole frame", worth.size() + 1, out_.paths);
    simulate_base(worth.size());
    if (out_.complete) relax_contenders(worth);
    return true;
  }

  /// Relaxes those of these classes that may be the best: of many, the two that promise most, and then those that may
  /// still gain more. One that gains less than another surely does is left out, and keeps the gain of an earlier pilot.
  void relax_contenders(const std::vector<std::size_t>& classes) {
    constexpr std::size_t kMany = 4, kFirst = 2;
    for (bool first = true;; first = false) {
      double surely = 0;
      for (const std::size_t i : classes) surely = std::max(surely, out_.gains[i].low);
      std::vector<std::size_t> missing;
      for (const std::size_t i : classes)
        if (relaxed_[i].paths != out_.paths && out_.gains[i].high >= surely) missing.push_back(i);
      if (first && missing.size() >= kMany) missing.resize(kFirst);
      // After that, the one that would be named by an earlier pilot's gain.
      if (const auto best = named_gain(out_.gains); missing.empty() && best && out_.gains[*best].together == 1 &&
                                                    relaxed_[*best].paths != out_.paths && affords(1, kAtMost)) {
        missing.push_back(*best);
        pilots_.expect_more(std::find(classes.begin(), classes.end(), *best) == classes.end());
      }
      if (missing.empty()) break;
      relax(missing);
      if (!out_.complete) return;
    }
    for (const std::size_t i : classes)
      if (relaxed_[i].paths != out_.paths) pilots_.leave_out_one();
  }

  /// True if a larger pilot has nothing to add: it is sure which class to name, and the pilot is like the run, or the
  /// class stands out in spite of the difference.
  bool told() { return judge() && sure(out_.gains); }

  /// Paths of a larger pilot, which is to relax these classes, or fewer of them; 0 if the budget has none.
  std::uint64_t next_paths(std::vector<std::size_t>& worth) const {
    if (out_.whole && budget_.left(kWithFrame, out_.simulated) < 1) return 0;
    if (!out_.unlike.empty()) return paths_after_unlike(budget_, out_.paths, cold_, out_.simulated, worth);
    if (worth.empty()) return 0;
    const double most = budget_.left(kAtMost, out_.simulated);
    const double left =
        budget_.left(kWanted, out_.simulated) - budget_.of(seeds_.paths, static_cast<std::size_t>(noise_seeds_));
    for (std::size_t n = worth.size(); left > 0 && n >= kFewest; --n) {
      const std::uint64_t wanted =
          pilot_paths(config_, run_.paths, frame(), budget_.share(left, n + 1), PilotSize::kFull);
      if (wanted < out_.paths + out_.paths / 2 || budget_.of(wanted, n + 1) > most) continue;
      worth.resize(n);
      return wanted;
    }
    if (stops_ && named_gain(out_.gains)) return 0;  // the frame as configured is not known then
    const std::optional<std::size_t> next = most_promising(out_.gains, [this](std::size_t i) {
      const auto relaxed = relaxed_.find(i);
      return relaxed != relaxed_.end() && relaxed->second.paths >= run_.paths;
    });
    if (!next) return 0;
    std::erase(worth, *next);
    worth.insert(worth.begin(), *next);
    return paths_against_noise(budget_, out_.paths, out_.simulated, worth);
  }

  /// Simulates a pilot with other seeds: its places in the picture are the same, and their rays are others. It is the
  /// last pilot, or twice as large if the budget has so much left, or the first one if it has less.
  void find_noise() {
    if (noise_seeds_ == 0) return;
    const auto seeds = static_cast<std::size_t>(noise_seeds_);
    const std::uint64_t twice = 2 * out_.paths;
    BasePilot of{out_.paths, draw_, static_cast<double>(base_.cycle->cycles)};
    if (twice <= run_.paths && budget_.of(twice, seeds + 1) <= budget_.left(kWithNoise, out_.simulated))
      of = {twice, draw_, 0};
    else if (budget_.of(out_.paths, seeds) > budget_.left(kWithNoise, out_.simulated))
      of = seeds_;
    if (budget_.of(of.paths, seeds) > budget_.left(out_.whole && !cold_ ? kWithFrame : kAtMost, out_.simulated)) return;
    pilots_.begin("other seeds", seeds + (of.cycles > 0 ? 0 : 1), of.paths);
    pilots_.take(of.draw);
    std::deque<Config> machines;
    std::vector<const Config*> which;
    if (of.cycles <= 0) which.push_back(&config_);
    for (std::uint64_t k = 1; k <= noise_seeds_; ++k)
      which.push_back(&machines.emplace_back(with_other_seed(config_, k)));
    std::vector<double> cycles;
    if (of.cycles > 0) cycles.push_back(of.cycles);
    for (const RunResult& result : simulate(which))
      if (out_.complete) cycles.push_back(static_cast<double>(result.cycle->cycles));
    if (!out_.complete) return;
    out_.noise = cycle_noise(cycles, of.paths >= run_.paths);
    out_.noise_paths = of.paths;
  }

  /// Compares the pilot's cycles and busy times, as foretold for the frame, with those of the run. Returns true if they
  /// are alike, or if a class is worth naming in spite of the difference, which widens its interval, unless the cycles
  /// differ by much.
  bool judge() {
    const Estimate cycles = foretelling(base_).cycles();
    out_.uncertainty = (cycles.high - cycles.value) / cycles.value;
    const double ran = stops_ ? cycles.value : static_cast<double>(run_.result.cycle->cycles);
    out_.rays_per_kilocycle = rays_per_kilocycle(frame(), ran);
    out_.deviation = likeness_.deviation;
    out_.unlike =
        likeness_.veto([this](std::string_view part) { return matters(out_.gains, *run_.result.cycle, part); });
    if (stands_out(out_.gains, likeness_.deviation)) out_.unlike.clear();
    return out_.unlike.empty();
  }

  Config config_;
  const accel::Accel& accel_;
  const SearchedRun& run_;
  SearchBudget budget_;
  PilotRuns pilots_;
  bool stops_ = false, cold_ = false;         // a resource; caches of the run
  bool fixed_work_ = false;                   // of tests and shading
  std::uint64_t noise_seeds_ = 0, draw_ = 0;  // draw_: of the present pilot
  BasePilot seeds_;                           // the first pilot
  std::vector<WhatIf> what_ifs_;
  std::map<std::size_t, RelaxedPilot> relaxed_;  // by index of what_ifs_
  RunResult base_;
  Likeness likeness_;  // of the present pilot; a run in which a resource stops is not compared
  Bottleneck out_;
};

}  // namespace

Bottleneck find_bottleneck(const Config& config, const accel::Accel& accel, float scene_size,
                           const PilotFactory& make_pilot, const SearchedRun& run, const RunOptions& options,
                           const SearchObserver& observe) {
  return Search(config, accel, scene_size, make_pilot, run, options, observe).search();
}

std::uint64_t least_paths_to_search(const Config& config, const accel::Accel& accel, const SearchedRun& run) {
  return Search(config, accel, 0, {}, run, {}, {}).least_paths();
}

}  // namespace carousel::ringbus
