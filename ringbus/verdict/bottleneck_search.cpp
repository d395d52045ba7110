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
#include "ringbus/verdict/frame_beginning.h"
#include "ringbus/verdict/frame_race.h"
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
        pilots_(accel, scene_size, make_pilot, run, slots_of(config), options, observe) {
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
    out_.paths = first_paths(config_, run_.paths, budget_, first, stops_ ? kWanted : kScreening);
    if (budget_.of(out_.paths, first) > kAtMost) {
      out_.least_paths = least_frame(config_, run_, first);
      out_.gains.clear();
      return out_;
    }
    pilots_.begin("pilot", first, out_.paths);
    screen(groups);
    if (out_.complete) try_seldom();
    if (out_.complete) out_.phases = gain_phases(base_, what_ifs_, relaxed_);
    seeds_ = {out_.paths, draw_, base_.cycle ? pilots_.cycles(*base_.cycle) : 0};
    while (out_.complete && !told() && look_again()) continue;
    if (out_.complete) judge();
    if (out_.complete) find_noise();
    if (!out_.complete || !out_.unlike.empty()) {
      out_.gains.clear();
      out_.phases.clear();
    }
    for (const Untried& one : out_.untried)
      std::erase_if(out_.gains, [&](const Gain& gain) { return gain.name == one.name; });
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

  /// So many simulations of the pilot keep within this part of the run's rays.
  bool affords(std::size_t simulations, double part) const {
    return pilots_.taken() + budget_.of(out_.paths, simulations) <= part;
  }

  /// The most that a class may gain by the run's ledger, which is not that of a machine in which a resource stops.
  double most(std::size_t i) const {
    return stops_ ? std::numeric_limits<double>::infinity()
                  : most_gain(*run_.result.cycle, what_ifs_[i].name(), fixed_work_);
  }

  std::vector<RunResult> simulate(const std::vector<const Config*>& machines) {
    std::vector<RunResult> results = pilots_.simulate(machines);
    note_cost();
    return results;
  }

  void note_cost() {
    out_.complete &= pilots_.complete();
    out_.simulated = pilots_.simulated_rays();
    out_.taken = pilots_.taken();
  }

  std::vector<RunResult> simulate_relaxed(const std::vector<std::size_t>& classes) {
    std::vector<const Config*> machines;
    for (const std::size_t i : classes) machines.push_back(&what_ifs_[i].relaxed);
    return simulate(machines);
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
    constexpr std::uint64_t kDraws = 4;
    constexpr double kLittle = 0.25;
    std::uint64_t taken = 0;
    for (std::uint64_t draw = 0; draw < kDraws; ++draw) {
      pilots_.take(draw);
      RunResult drawn = simulate({&config_}).front();
      if (!out_.complete) return;
      const double off = stops_ ? 0 : likeness(foretelling(drawn), *run_.result.cycle).off();
      if (draw == 0 || off < likeness_.off()) {
        taken = draw;
        set_base(std::move(drawn));
      }
      if (likeness_.off() <= kLike || budget_.of(out_.paths, draw + 2) > kLittle || !affords(others + 1, kScreened))
        break;
      pilots_.expect_more(1);
    }
    draw_ = taken;
    pilots_.take(taken);
  }

  bool more_slots(std::size_t i) const { return what_ifs_[i].name() == "ray_slots"; }
  /// Completed rays after which the machine is full, or one with twice its ray slots.
  std::uint64_t fill(bool more_slots = false) const { return (more_slots ? 2 : 1) * fill_rays(slots_of(config_)); }

  Foretelling foretelling(const RunResult& base, bool more_slots = false) const {
    return {{&*base.cycle, base.rays_completed}, frame(), fill(more_slots), stops_ ? nullptr : &*run_.result.cycle};
  }

  /// Simulates the pilot as configured and with each class that stands alone relaxed; then with each group; then with
  /// parts of those that may gain enough, down to single classes, the most promising first, as the budget allows.
  void screen(std::vector<std::vector<std::size_t>> groups) {
    std::vector<std::vector<std::size_t>> later;
    for (const std::vector<std::size_t>& group : groups)
      if (group.size() > 1) later.push_back(group);
    std::erase_if(groups, [](const std::vector<std::size_t>& group) { return group.size() > 1; });
    simulate_base(groups.size() + later.size());
    double budget = kWanted;
    for (int round = 0; out_.complete && !(groups.empty() && later.empty()); ++round) {
      std::vector<std::vector<std::size_t>> tried;
      std::deque<Config> together;
      std::vector<const Config*> machines;
      for (std::size_t k = 0; k < groups.size() && (round < 2 || affords(machines.size() + 1, budget)); ++k) {
        const std::vector<std::size_t> group = groups[k];
        if (!pilots_.drains() && group.size() == 1 && more_slots(group.front())) {
          look_at_slots(group.front());
          continue;
        }
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
          relaxed_[tried[k].front()] = std::move(results[k]);
      }
      // More of what stands idle costs nothing, so what all of them gain is at least what each does, but for chance.
      std::stable_sort(several.begin(), several.end(),
                       [](const auto& a, const auto& b) { return a.second.value > b.second.value; });
      // A group that gains more than any class that was looked at alone leaves nothing to name.
      budget = !several.empty() && several.front().second.value > likely(out_.gains) ? kAtMost : kScreened;
      groups = std::exchange(later, {});
      for (const auto& [group, gain] : several)
        if (gain.value >= kEnough && (!likeness_.other_cycles || gain.low > 0)) divide(group, groups);
      leave_out(groups, out_.gains, std::max(kEnough, surely(out_.gains)));
    }
  }

  /// Simulates the classes that seldom gain, if they may gain enough, as far as the budget of the screening allows.
  void try_seldom() {
    for (std::size_t i = 0; i < what_ifs_.size(); ++i) {
      if (!seldom_gains(what_ifs_[i]) || out_.gains[i].high < std::max(kWorthIt, surely(out_.gains))) continue;
      if (!affords(1, kScreened)) {
        note(i, {}, 0);
        out_.untried.push_back({what_ifs_[i].name(), what_ifs_[i].part.action,
                                "it seldom gains, and other classes took the rays of the search"});
        continue;
      }
      pilots_.expect_more(1);
      std::vector<RunResult> results = simulate_relaxed({i});
      if (!out_.complete) return;
      note(i, gain_of({i}, results.front()), 1);
      relaxed_[i] = std::move(results.front());
    }
  }

  /// A machine with more ray slots has more rays under way when another is done with the pilot's, and those of it that
  /// were completed are the short ones. So both simulate the pilot to its end.
  void look_at_slots(std::size_t i) {
    pilots_.expect_more(1);
    std::vector<RunResult> results = pilots_.simulate_to_the_end({&config_, &what_ifs_[i].relaxed});
    note_cost();
    if (!out_.complete) return;
    const Estimate gain =
        foretelling(results.front(), true).gain({&*results.back().cycle, results.back().rays_completed}, off());
    note(i, of_few_slots(gain), 1);
    relaxed_[i] = std::move(results.back());
  }

  void divide(const std::vector<std::size_t>& group, std::vector<std::vector<std::size_t>>& parts) {
    const std::vector<std::vector<std::size_t>> own = parts_of(group);
    parts.insert(parts.end(), own.begin(), own.end());
    pilots_.expect_more(own.size());
  }

  /// Pilots begin with warm caches, and tell nothing of this class then.
  bool gains_of_cold(std::size_t i) const { return cold_ && gains_of_cold_caches(what_ifs_[i].name()); }

  /// Notes what a class gains that was relaxed with others, or not simulated (0), by a pilot or a part of the frame
  /// from its start: within what the run allows, or more where a pilot tells nothing.
  void note(std::size_t i, const Estimate& gain, std::size_t together, double part = 0) {
    const WhatIf& what = what_ifs_[i];
    const bool known = part >= 1 || (together == 1 && out_.whole);
    const double beyond = part > 0 || known || together == 0 ? 0
                          : gains_of_cold(i)                 ? 1
                                                             : gain_beyond(gain, what.name()),
                 high = known ? gain.high : std::min(gain.high + beyond, most(i)), value = std::min(gain.value, high),
                 low = gain.low - (gain.value - value);
    const double rate = rays_per_kilocycle(run_.result.rays_completed, static_cast<double>(run_.result.cycle->cycles));
    out_.gains[i] = {what.name(), what.part.action, what.sets, rate * (1 + value), value, low, high, together, part};
    if (together == 1 && part <= 0) by_pilot_[i] = {value, low, high};
  }

  /// The gain of the machine with these classes relaxed, by the pilot with what this is known to be off by.
  Estimate gain_of(const std::vector<std::size_t>& classes, const RunResult& relaxed) const {
    const auto any = [&](const auto& is) { return std::any_of(classes.begin(), classes.end(), is); };
    const bool slots = any([&](std::size_t i) { return more_slots(i); }),
               warms = any([&](std::size_t i) { return what_ifs_[i].part.how.keeps_shapes; });
    const Estimate gain = foretelling(base_, slots).gain({&*relaxed.cycle, relaxed.rays_completed}, off(), warms);
    return slots && !out_.whole ? of_few_slots(gain) : gain;
  }
  /// A pilot that was taken since it is like the run is less so in what was not compared.
  double off() const { return std::max(kLike, likeness_.off()); }

  /// Goes on with the frame for the class that may tell most of which to name, and returns true then.
  bool look_again() {
    if (stops_ || out_.whole) return false;  // no run of the machine as configured; or its frame is known
    if (larger_pilot()) return true;
    const std::optional<std::size_t> next =
        next_look(out_.gains, out_.unlike.empty(), [this](std::size_t i) { return gains_of_cold(i) || more_slots(i); });
    if (!next) return false;
    const cycle::CycleResult& run = *run_.result.cycle;
    const double known = out_.gains[*next].frame,
                 part = next_part(run, known, fill(), part_within(known + kWithFrame - pilots_.taken()));
    if (part <= 0) return false;
    const FrameBeginning beginning = beginning_of(run, part);
    pilots_.begin_frame(beginning.rays - beginning_of(run, known).rays);
    const cycle::CycleResult relaxed = pilots_.go_on(what_ifs_[*next].relaxed, beginning);
    note_cost();
    if (!out_.complete) return false;
    Estimate gain = part < 1 ? gain_by_beginning(run, relaxed, beginning, fill(more_slots(*next)),
                                                 what_ifs_[*next].part.how.keeps_shapes)
                             : Foretelling({&run, frame()}, frame(), fill()).gain({&relaxed, frame()}, 0);
    if (const auto pilot = by_pilot_.find(*next); part < 1 && pilot != by_pilot_.end())
      gain = both(pilot->second, gain);
    note(*next, gain, 1, part);
    return true;
  }

  /// Simulates a larger pilot for these classes if the frame's beginning would not tell of its rest within what a
  /// search is to take, and returns true then.
  bool larger_pilot() {
    const double left = kWanted - for_noise() - pilots_.taken();
    std::vector<std::size_t> worth = worth_a_second_look(out_.gains, kContenders);
    const auto at_least = static_cast<double>(std::min(worth.size(), kFewest));
    if (worth.empty() || left <= 0 || any_frame(out_.gains) ||
        tells_of_rest(*run_.result.cycle, part_within(left / at_least), fill()))
      return false;
    for (std::size_t n = worth.size(); n >= std::min(worth.size(), kFewest); --n) {
      const auto paths =
          static_cast<std::uint64_t>(left / static_cast<double>(n + 1) * static_cast<double>(run_.paths));
      if (paths < out_.paths + out_.paths / 2) continue;
      worth.resize(n);
      out_.paths = paths;
      pilots_.begin("larger pilot", n + 1, paths);
      simulate_base(n);
      if (const auto slots = std::find_if(worth.begin(), worth.end(), [&](std::size_t i) { return more_slots(i); });
          out_.complete && slots != worth.end() && !pilots_.drains()) {
        look_at_slots(*slots);
        worth.erase(slots);
      }
      const std::vector<RunResult> results = simulate_relaxed(worth);
      if (!out_.complete) return false;
      for (std::size_t k = 0; k < worth.size(); ++k) note(worth[k], gain_of({worth[k]}, results[k]), 1);
      return true;
    }
    return false;
  }

  /// True if there is nothing to add: it is sure which class to name, and nothing speaks against it.
  bool told() { return judge() && sure(out_.gains); }

  /// The part of the run that simulations for the noise are to take.
  double for_noise() const { return budget_.of(seeds_.paths, noise_seeds_); }
  double part_within(double taken) const { return part_that_takes(*run_.result.cycle, frame(), taken); }

  /// Simulates a pilot with other seeds: the first one, or one twice as large if the budget has so much left.
  void find_noise() {
    if (noise_seeds_ == 0) return;
    const std::uint64_t twice = 2 * seeds_.paths;
    const bool larger = twice <= run_.paths && pilots_.taken() + budget_.of(twice, noise_seeds_ + 1) <= kWithNoise;
    const std::uint64_t paths = larger ? twice : seeds_.paths;
    if (pilots_.taken() + budget_.of(paths, noise_seeds_) > kWithFrame) return;
    const std::vector<double> cycles = cycles_of_seeds(pilots_, config_, noise_seeds_, seeds_, paths);
    note_cost();
    if (!out_.complete) return;
    out_.noise = cycle_noise(cycles, paths >= run_.paths);
    out_.noise_paths = paths;
  }

  /// Compares the pilot's cycles and busy times, as foretold for the frame, with those of the run. Returns true if they
  /// are alike, or if a class stands out in spite of the difference.
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
  std::vector<WhatIf> what_ifs_;
  PilotRuns pilots_;                          // of these
  bool stops_ = false, cold_ = false;         // a resource; caches of the run
  bool fixed_work_ = false;                   // of tests and shading
  std::uint64_t noise_seeds_ = 0, draw_ = 0;  // draw_: of the present pilot
  BasePilot seeds_;                           // the first pilot
  std::map<std::size_t, RunResult> relaxed_;  // by index of what_ifs_
  std::map<std::size_t, Estimate> by_pilot_;  // of those that were relaxed alone
  RunResult base_;
  Likeness likeness_;  // of the pilot; a run in which a resource stops is not compared
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
