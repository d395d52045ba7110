#include "ringbus/verdict/bottleneck_search.h"

#include <algorithm>
#include <cmath>
#include <deque>
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
      : config_(config), accel_(accel), run_(run), pilots_(accel, scene_size, make_pilot, run, options, observe) {
    // The bottleneck is that of the whole machine, before a resource stops.
    stops_ = config_.faults.resource.kind == FaultsConfig::Resource::Kind::kStop;
    if (stops_) config_.faults.resource = {};
    noise_seeds_ = stops_ ? 0 : run.noise_seeds;  // the whole machine's noise is not that of a run in which one stops
    what_ifs_ = what_ifs(config_, accel_);
    out_.gains.resize(what_ifs_.size());
    cold_ = cold(*run.result.cycle, slots_of(config_));
  }

  Bottleneck search() {
    const std::vector<std::vector<std::size_t>> groups = search_groups(what_ifs_, *run_.result.cycle);
    out_.paths = pilot_paths(config_, run_.paths, frame(),
                             share(kScreening, groups.size() + 1 + static_cast<std::size_t>(noise_seeds_)));
    pilots_.begin("first pilot", groups.size() + 1, out_.paths);
    screen(groups);
    const bool whole = out_.whole;
    if (!whole && out_.complete) find_noise();
    note_phases();
    if (out_.complete && !out_.whole && !told()) look_again();
    if (out_.complete) judge();
    if (whole && out_.complete) replicate();
    if (!out_.complete || !out_.unlike.empty()) {
      out_.gains.clear();
      out_.phases.clear();
    }
    std::stable_sort(out_.gains.begin(), out_.gains.end(), [](auto& a, auto& b) { return a.gain > b.gain; });
    return out_;
  }

 private:
  static constexpr double kScreening = 0.4;  // of the run's rays, that the first pilot is to take
  static constexpr double kWanted = 0.9;     // that all pilots are to take
  static constexpr double kAtMost = 1.6;     // that they may take to tell the greatest gain from noise

  std::uint64_t frame() const { return run_.result.rays_completed; }

  /// Rays of each of so many simulations that take this part of the run's rays together.
  std::uint64_t share(double part, std::size_t simulations) const {
    return static_cast<std::uint64_t>(std::max(0.0, part) * static_cast<double>(frame()) /
                                      static_cast<double>(simulations));
  }

  /// The part of the run's rays that so many simulations of these paths take.
  double part_of_run(std::uint64_t paths, std::size_t simulations) const {
    return static_cast<double>(simulations * paths) / static_cast<double>(run_.paths);
  }

  /// The part of the run's rays that a search of this extent has left.
  double left_of(double part) const {
    return part - static_cast<double>(out_.simulated) / static_cast<double>(frame());
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
  /// little, and goes on with the one that is most like it.
  void simulate_base() {
    if (base_is_the_run()) return;
    constexpr std::uint64_t kDraws = 4;
    constexpr double kLike = 0.05, kLittle = 0.3;
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
      if (likeness_.off() <= kLike || part_of_run(out_.paths, draw + 2) > kLittle) break;
      pilots_.expect_more(1);
    }
    pilots_.take(taken);
  }

  /// `more_slots`: for a machine with twice the ray slots, which is full later.
  Foretelling foretelling(const RunResult& base, bool more_slots = false) const {
    return {{&*base.cycle, base.rays_completed},
            frame(),
            (more_slots ? 2 : 1) * fill_rays(slots_of(config_)),
            stops_ ? nullptr : &*run_.result.cycle};
  }

  /// Simulates the pilot as configured and with the classes of each group relaxed together; then parts of the groups
  /// for which that may gain enough, down to single classes.
  void screen(std::vector<std::vector<std::size_t>> groups) {
    simulate_base();
    while (out_.complete && !groups.empty()) {
      std::vector<std::vector<std::size_t>> tried, parts;
      std::deque<Config> together;
      std::vector<const Config*> machines;
      for (std::vector<std::size_t>& group : groups) {
        std::vector<const WhatIf*> members;
        for (const std::size_t i : group) members.push_back(&what_ifs_[i]);
        std::optional<Config> machine =
            group.size() == 1 ? members.front()->relaxed : relaxed_together(config_, members);
        if (!machine) {
          divide(group, parts);
          continue;
        }
        machines.push_back(&together.emplace_back(std::move(*machine)));
        tried.push_back(std::move(group));
      }
      std::vector<RunResult> results = simulate(machines);
      if (!out_.complete) return;
      std::vector<std::pair<std::vector<std::size_t>, Estimate>> several;
      for (std::size_t k = 0; k < tried.size(); ++k) {
        const Estimate gain = gain_of(tried[k], results[k]);
        if (tried[k].size() > 1) {
          several.emplace_back(std::move(tried[k]), gain);
          continue;
        }
        relaxed_[tried[k].front()] = {std::move(results[k]), out_.paths};
        note(tried[k].front(), gain, 1);
      }
      // More of what stands idle costs nothing, so what all of them gain is at least what each does, but for chance.
      // A pilot that is not like the run, and may not even tell that from nothing, tells less of each.
      const double enough = std::max(kEnough, surely(out_.gains));
      for (const auto& [group, gain] : several) {
        if (gain.value < kEnough || gain.high < enough || (likeness_.other_cycles && gain.low <= 0))
          for (const std::size_t i : group) note(i, gain, group.size());
        else
          divide(group, parts);
      }
      groups = std::move(parts);
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

  void note(std::size_t i, const Estimate& gain, std::size_t together) {
    const double rate = rays_per_kilocycle(run_.result.rays_completed, static_cast<double>(run_.result.cycle->cycles));
    out_.gains[i] = {what_ifs_[i].name(), what_ifs_[i].part.action,
                     what_ifs_[i].sets,   rate * (1 + gain.value),
                     gain.value,          gain.low,
                     gain.high,           together};
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
    return foretelling(base_, slots).gain({&*relaxed.cycle, relaxed.rays_completed}, likeness_.off(), warms);
  }

  /// Notes the gains of classes that were relaxed with the present pilot, with what this is known to be off by.
  void estimate(const std::vector<std::size_t>& classes) {
    for (const std::size_t i : classes) {
      const RunResult& result = relaxed_[i].result;
      note(i, gain_of({i}, result), 1);
    }
  }

  /// Simulates a larger pilot if it may tell more.
  void look_again() {
    const bool of_memory = cold_ && !out_.unlike.empty();
    std::vector<std::size_t> worth =
        worth_a_second_look(out_.gains, of_memory || likeness_.other_cycles ? kFewest : kContenders, of_memory);
    const std::uint64_t paths = next_paths(worth);
    if (paths == 0) return;
    out_.paths = paths;
    pilots_.begin("second pilot", worth.size() + 1, out_.paths);
    simulate_base();
    if (out_.complete) relax_contenders(worth);
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
      if (const auto best = named_gain(out_.gains);
          missing.empty() && best && out_.gains[*best].together == 1 && relaxed_[*best].paths != out_.paths) {
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

  /// Paths of a second pilot, which is to relax these classes; 0 if what it takes is not worth it. If the first one is
  /// not like the run, another follows, whatever that takes.
  std::uint64_t next_paths(std::vector<std::size_t>& worth) const {
    const std::uint64_t twice = std::min(run_.paths, 2 * out_.paths);
    if (!out_.unlike.empty()) return paths_after_unlike(out_.paths, run_.paths, worth.size(), cold_);
    if (worth.empty()) return 0;
    const std::uint64_t wanted = pilot_paths(config_, run_.paths, frame(), share(left_of(kWanted), worth.size() + 1));
    if (left_of(kWanted) > 0 && wanted >= out_.paths + out_.paths / 2) return wanted;
    const Gain& best = out_.gains[worth.front()];
    if (best.gain < kWorthIt || worth_naming(best.gain, best.low)) return 0;
    // The greatest gain may be noise.
    worth.resize(std::min(worth.size(), kFewest));
    return part_of_run(twice, worth.size() + 1) <= left_of(kAtMost) ? twice : 0;
  }

  /// Notes the noise of the cycles by those of pilots of so many paths with the run's seed and with others.
  void note_noise(const std::vector<double>& cycles, std::uint64_t paths) {
    out_.noise = cycle_noise(cycles, paths >= run_.paths);
    out_.noise_paths = paths;
  }

  /// Simulates the pilot with other seeds: its places in the picture are the same, and their rays are others. Where no
  /// larger pilot is to follow, what the search has left makes these pilots larger, and their noise smaller.
  void find_noise() {
    if (noise_seeds_ == 0) return;
    const std::uint64_t twice = 2 * out_.paths;
    const bool larger = told() && twice <= run_.paths && part_of_run(twice, noise_seeds_ + 1) <= left_of(kWanted);
    const std::uint64_t of_gains = std::exchange(out_.paths, larger ? twice : out_.paths);
    pilots_.begin("other seeds", noise_seeds_ + (larger ? 1 : 0), out_.paths);
    std::deque<Config> machines;
    std::vector<const Config*> which;
    for (std::uint64_t k = larger ? 0 : 1; k <= noise_seeds_; ++k)
      which.push_back(k == 0 ? &config_ : &machines.emplace_back(with_other_seed(config_, k)));
    std::vector<double> cycles;
    if (!larger) cycles.push_back(static_cast<double>(base_.cycle->cycles));
    for (const RunResult& result : simulate(which))
      if (out_.complete) cycles.push_back(static_cast<double>(result.cycle->cycles));
    if (out_.complete) note_noise(cycles, out_.paths);
    out_.paths = of_gains;
  }

  /// Simulates the whole frame with other seeds of the picture, as configured and with the classes that may be named,
  /// widens the intervals of these to hold what they gain there, and notes the noise of the cycles.
  void replicate() {
    constexpr std::uint64_t kReplicates = 2;
    constexpr std::size_t kMost = 3;
    std::vector<std::size_t> named;
    for (std::size_t i = 0; i < out_.gains.size(); ++i)
      if (worth_naming(out_.gains[i].gain, out_.gains[i].low)) named.push_back(i);
    greatest_first(out_.gains, named);
    named.resize(std::min(named.size(), kMost));
    const std::uint64_t replicates = named.empty() ? 0 : kReplicates;
    std::deque<Config> machines;
    for (std::uint64_t k = 1; k <= std::max(replicates, noise_seeds_); ++k) {
      machines.push_back(with_other_seed(config_, k));
      for (const std::size_t i : named)
        if (k <= replicates) machines.push_back(with_other_seed(what_ifs_[i].relaxed, k));
    }
    if (machines.empty()) return;
    pilots_.begin("other seeds", machines.size(), out_.paths);
    std::vector<const Config*> which;
    for (const Config& machine : machines) which.push_back(&machine);
    const std::vector<RunResult> results = simulate(which);
    if (!out_.complete) return;
    std::vector<double> cycles;
    for (auto at = results.begin(); at != results.end();) {
      cycles.push_back(static_cast<double>(at++->cycle->cycles));
      for (std::size_t n = 0; n < named.size() && cycles.size() <= replicates; ++n) {
        Gain& gain = out_.gains[named[n]];
        const double there = cycles.back() / static_cast<double>(at++->cycle->cycles) - 1;
        gain.low = std::min(gain.low, there);
        gain.high = std::max(gain.high, there);
      }
    }
    out_.replicates = replicates;
    cycles.push_back(static_cast<double>(base_.cycle->cycles));
    if (noise_seeds_ > 0) note_noise(cycles, out_.paths);
  }

  /// Compares the pilot's cycles and busy times, as foretold for the frame, with those of the run. Returns true if they
  /// are alike, or if a class is worth naming in spite of the difference, which widens its interval, unless the cycles
  /// differ by much.
  bool judge() {
    constexpr double kMuch = 0.25;
    const Estimate cycles = foretelling(base_).cycles();
    out_.uncertainty = (cycles.high - cycles.value) / cycles.value;
    const double ran = stops_ ? cycles.value : static_cast<double>(run_.result.cycle->cycles);
    out_.rays_per_kilocycle = rays_per_kilocycle(frame(), ran);
    out_.deviation = likeness_.deviation;
    out_.unlike =
        likeness_.veto([this](std::string_view part) { return matters(out_.gains, *run_.result.cycle, part); });
    if (std::abs(likeness_.deviation) <= kMuch && named_gain(out_.gains)) out_.unlike.clear();
    return out_.unlike.empty();
  }

  /// A relaxed machine's run, and the pilot that it was.
  struct Relaxed {
    RunResult result;
    std::uint64_t paths = 0;
  };

  Config config_;
  const accel::Accel& accel_;
  const SearchedRun& run_;
  PilotRuns pilots_;
  bool stops_ = false, cold_ = false;  // a resource; caches of the run
  std::uint64_t noise_seeds_ = 0;
  std::vector<WhatIf> what_ifs_;
  std::map<std::size_t, Relaxed> relaxed_;  // by index of what_ifs_
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

}  // namespace carousel::ringbus
