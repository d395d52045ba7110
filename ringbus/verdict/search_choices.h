#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>
#include <vector>

#include "core/numeric/worth_naming.h"
#include "ringbus/results/cycle_result.h"
#include "ringbus/verdict/bottleneck_search.h"
#include "ringbus/verdict/cold_caches.h"
#include "ringbus/verdict/foretell.h"
#include "ringbus/verdict/what_if.h"

namespace carousel::ringbus {

// What the search for the bottleneck looks at next, and when it has seen enough. Classes are given by index.

/// A gain that is worth a second look, and a difference of gains that settles a tie.
inline constexpr double kEnough = kTie;
/// A pilot that differs from the run by this part or less is taken without a further draw.
inline constexpr double kLike = 0.05;
/// Classes that a larger pilot is simulated for at most, and at least if there are so many.
inline constexpr std::size_t kContenders = 6, kFewest = 2;

inline double rays_per_kilocycle(std::uint64_t rays, double cycles) {
  return 1000 * static_cast<double>(rays) / std::max(1.0, cycles);
}

/// The part of the run's time in which the parts of a class were busy, in the mean; 1 if nobody counts that.
inline double busy(const cycle::CycleResult& run, std::string_view part) {
  for (const cycle::ClassUse& use : run.uses)
    if (use.name == part) return static_cast<double>(use.busy) / (use.parts * static_cast<double>(run.cycles));
  return 1;
}

/// The part of the run's time in which resources waited for what a class of parts makes shorter: in the mean, and half
/// as much again, since others wait for their rays; or half the time of the one that waited most, if that is more. A
/// resource whose packet waits for shapes counts as waiting for tests while another packet is in test, so that may be
/// time of the memory, too. 1 if nobody counts that. Warps and the resources of a central machine wait in other ways.
inline double waited(const cycle::CycleResult& run, std::string_view part) {
  using cycle::TileState;
  constexpr std::array<std::string_view, 12> kMemory{
      "memory_latency", "memory_bandwidth", "fetch_ahead", "shape_buffer", "l1_size",  "l1_port",
      "l1_mshrs",       "l2_size",          "l2_port",     "l2_mshrs",     "prefetch", "dram_queue"};
  const bool memory = std::find(kMemory.begin(), kMemory.end(), part) != kMemory.end(),
             credits = part == "packets_in_flight", storage = part == "collection_storage",
             latency = part == "test_latency";
  if (run.tiles.empty() || (!memory && !credits && !storage && !latency)) return 1;
  constexpr double kOthersWait = 1.5, kBehindTests = 1;
  Cycle sum = 0, behind = 0, most = 0;
  for (const cycle::TileResult& tile : run.tiles) {
    if (tile.warps || tile.distributor) return 1;
    const Cycle own = latency ? tile.testing.latency
                              : tile.states[static_cast<std::size_t>(memory    ? TileState::kMemory
                                                                     : credits ? TileState::kCredits
                                                                               : TileState::kStorage)];
    sum += own;
    behind += memory ? tile.testing.latency : 0;
    most = std::max(most, own);
  }
  return std::max((kOthersWait * static_cast<double>(sum) + kBehindTests * static_cast<double>(behind)) /
                      static_cast<double>(run.tiles.size()),
                  static_cast<double>(most) / 2) /
         static_cast<double>(run.cycles);
}

/// True if tests and shading take as many cycles whichever rays meet: one at a time, without programs, whose time
/// depends on caches. A ray that takes several ways at once does a percent more or fewer tests with other timing.
inline bool work_is_fixed(const Config& config, const cycle::CycleResult& run) {
  const bool shared = std::any_of(run.tiles.begin(), run.tiles.end(),
                                  [](const cycle::TileResult& tile) { return tile.warps || tile.distributor; });
  return !shared && !has_cells(config) && !run.ray_data && config.shading.lanes <= 1 && !config.shading.program.any() &&
         !config.shading.idle_resources_shade && busy(run, "bundle_tests") == 0;
}

/// The most that a class may gain by the work of other classes, which takes as long as before: the tests and the
/// shading of the run, if these are fixed.
inline double most_beside_work(const cycle::CycleResult& run, std::string_view part) {
  double most = 0;
  for (const cycle::ClassUse& use : run.uses)
    if (use.parts > 0 && use.name != part &&
        (use.name == "box_tests" || use.name == "triangle_tests" || use.name == "shading"))
      most = std::max(most, busy(run, use.name));
  return most > 0 ? 1 / std::min(1.0, most) - 1 : std::numeric_limits<double>::infinity();
}

/// The time that goes with a class of parts, half of which twice as many save on the busiest one; as if all of it goes
/// where nobody counts it. One part has up to twice the time of the mean, or more where parts differ. Banks of DRAM
/// take time beside that of its data, and twice the channels have twice the banks.
inline std::optional<double> time_of(const cycle::CycleResult& run, std::string_view part) {
  if (part == "memory_bandwidth" && run.dram) return std::nullopt;
  for (const cycle::ClassUse& use : run.uses)
    if (use.parts > 0 && use.name == part)
      return std::max(busy(run, part), static_cast<double>(use.most) / 2 / static_cast<double>(run.cycles));
  return std::nullopt;
}

/// The most that a class may gain by the lines that memory reads for the first time in the run, which no other part
/// spares it.
inline double most_beside_first_reads(const cycle::CycleResult& run, std::string_view part) {
  if (part == "memory_bandwidth" || run.memory.lines == 0) return std::numeric_limits<double>::infinity();
  const double reads = std::min(1.0, static_cast<double>(run.first_reads) / static_cast<double>(run.memory.lines)),
               taken = reads * busy(run, "memory_bandwidth");
  return taken > 0 ? 1 / std::min(1.0, taken) - 1 : std::numeric_limits<double>::infinity();
}

/// The most that a class may gain. Half of the time that goes with it is saved, or all of it with room for what is
/// fetched again, but no part has more than the run's. Of 363 gains of parts in machines drawn by `script/verdicts
/// --drawn`, one was greater, by half a point. Of 407 gains none was greater than what others' work leaves. Infinite
/// where neither is known.
inline double most_gain(const cycle::CycleResult& run, std::string_view part, bool fixed_work) {
  constexpr double kSchedule = 0.03;
  const std::optional<double> counted = time_of(run, part);
  const double time = std::min(counted.value_or(1), waited(run, part)),
               own = time < 0.5 ? time / (1 - time)
                     : counted  ? 1.0
                                : std::numeric_limits<double>::infinity();
  return std::min({own, most_beside_first_reads(run, part), fixed_work ? most_beside_work(run, part) : own}) +
         kSchedule;
}

/// True if a class is relaxed by another rule, which may lose.
inline bool is_choice(std::string_view part) {
  return part == "issue_rule" || part == "shading_order" || part == "stragglers";
}

/// True if a class so seldom gains that it is looked at last, and only if the budget allows: collections that wait for
/// their resource to be idle, where they went ahead. Of 343 machines drawn by `script/verdicts --drawn` none gained 5 %
/// by that.
inline bool seldom_gains(const WhatIf& what) {
  return what.name() == "issue_rule" && what.relaxed.collections.partial == Partial::kIdle;
}

/// By how much more than its interval says a class may gain in the frame that loses in a pilot: what it loses. More of
/// a part lost 3 % or more in 15 of 660 relaxations of machines drawn by `script/verdicts --drawn`, and 7.5 % at most:
/// a pilot in which it surely loses more tells nothing of it, and it may gain 100 % or what the ledger allows.
inline double gain_beyond(const Estimate& pilot, std::string_view part) {
  constexpr double kMostLost = 0.075;
  return pilot.high < -kMostLost && !is_choice(part) ? 1 - pilot.high : std::max(0.0, -pilot.value);
}

/// The interval of what a pilot says of more ray slots. A small one hardly sees them full: of 177 such gains
/// ten lay outside of their interval, by up to 90 points.
inline Estimate of_few_slots(const Estimate& pilot) {
  constexpr double kError = 0.3;
  return {pilot.value, pilot.value - std::hypot(pilot.value - pilot.low, kError),
          pilot.value + std::hypot(pilot.high - pilot.value, kError)};
}

/// True if the parts of a class had nothing to do for more than half of the run.
inline bool idle(const cycle::CycleResult& run, std::string_view part) {
  return busy(run, part) <= 0.5;
}

/// The classes that are relaxed together: those of idle parts, and those of which nobody counts how busy they are,
/// which others wait for, and which more of harms no other part. The others stand alone, but for those that seldom
/// gain.
inline std::vector<std::vector<std::size_t>> search_groups(const std::vector<WhatIf>& classes,
                                                           const cycle::CycleResult& run) {
  std::vector<std::vector<std::size_t>> out;
  std::vector<std::size_t> of_idle, of_waits;
  for (std::size_t i = 0; i < classes.size(); ++i) {
    const std::string_view name = classes[i].name();
    if (seldom_gains(classes[i])) continue;
    if (idle(run, name))
      of_idle.push_back(i);
    else if (classes[i].part.how.keeps_shapes || name.ends_with("_latency") || name == "collection_storage" ||
             name == "fetch_ahead" || name == "dram_queue")
      of_waits.push_back(i);
    else
      out.push_back({i});
  }
  for (const std::vector<std::size_t>& group : {of_waits, of_idle})
    if (!group.empty()) out.push_back(group);
  return out;
}

/// The parts of a group that may gain enough: halves, or single classes of a few, of which halves would spare nothing
/// where two gain.
inline std::vector<std::vector<std::size_t>> parts_of(const std::vector<std::size_t>& group) {
  constexpr std::size_t kFew = 5;
  const std::size_t each = group.size() <= kFew ? 1 : (group.size() + 1) / 2;
  std::vector<std::vector<std::size_t>> out;
  for (std::size_t at = 0; at < group.size(); at += each)
    out.emplace_back(group.begin() + static_cast<std::ptrdiff_t>(at),
                     group.begin() + static_cast<std::ptrdiff_t>(std::min(at + each, group.size())));
  return out;
}

/// Leaves out the classes of these groups that cannot gain so much by what is known of them.
inline void leave_out(std::vector<std::vector<std::size_t>>& groups, const std::vector<Gain>& gains, double enough) {
  for (std::vector<std::size_t>& group : groups)
    std::erase_if(group, [&](std::size_t i) { return gains[i].high < enough; });
  std::erase_if(groups, [](const std::vector<std::size_t>& group) { return group.empty(); });
}

/// By the middle of their intervals: that of a gain of which a pilot tells nothing reaches far up.
inline void greatest_first(const std::vector<Gain>& gains, std::vector<std::size_t>& classes) {
  const auto middle = [&](std::size_t i) { return gains[i].low + gains[i].high; };
  std::stable_sort(classes.begin(), classes.end(), [&](std::size_t a, std::size_t b) { return middle(a) > middle(b); });
}

/// The class that a verdict would name; absent if it would name none.
inline std::optional<std::size_t> named_gain(const std::vector<Gain>& gains) {
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < gains.size(); ++i)
    if (gains[i].together == 1 && worth_naming(gains[i].gain, gains[i].low) &&
        (!best || likely_gain(gains[i].gain, gains[i].low) > likely_gain(gains[*best].gain, gains[*best].low)))
      best = i;
  return best;
}

/// True if a class is worth naming although the run's cycles differ so from those that the pilot foretells; or because
/// the frame's beginning tells of it, which needs no pilot.
inline bool stands_out(const std::vector<Gain>& gains, double deviation) {
  constexpr double kMuch = 0.4;
  const std::optional<std::size_t> named = named_gain(gains);
  return named && (std::abs(deviation) <= kMuch || gains[*named].frame > 0);
}

/// What the class that a verdict would name is likely to gain; 0 if it would name none.
inline double likely(const std::vector<Gain>& gains) {
  const std::optional<std::size_t> best = named_gain(gains);
  return best ? likely_gain(gains[*best].gain, gains[*best].low) : 0;
}

/// What the class that a verdict would name surely gains; 0 if it would name none.
inline double surely(const std::vector<Gain>& gains) {
  const std::optional<std::size_t> best = named_gain(gains);
  return best ? gains[*best].low : 0;
}

/// True if the interval of the class to be named lies apart from all others, but for a difference that settles a tie;
/// or if none reaches what is worth naming.
inline bool sure(const std::vector<Gain>& gains) {
  const std::optional<std::size_t> best = named_gain(gains);
  const double enough = best ? gains[*best].low + kEnough : kWorthIt;
  for (std::size_t i = 0; i < gains.size(); ++i)
    if (i != best && gains[i].high > enough) return false;
  return true;
}

/// True if most of what the run waited for may be first reads of lines: memory was busy for most of it. Part of such a
/// frame is not like it, since no pilot knows when the frame reads a line first.
inline bool cold(const cycle::CycleResult& run, std::uint64_t slots) {
  return !idle(run, "memory_bandwidth") && reads_between(run, slots).first_share() >= kColdShare;
}

/// A part matters if more of it gains something, or if it is busy for most of the run.
inline bool matters(const std::vector<Gain>& gains, const cycle::CycleResult& run, std::string_view part) {
  const auto gain = std::find_if(gains.begin(), gains.end(), [&](const Gain& one) { return one.name == part; });
  return (gain != gains.end() && gain->gain >= kEnough) || !idle(run, part);
}

}  // namespace carousel::ringbus
