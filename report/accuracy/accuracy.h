#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace carousel::report {

/// A measurement over interleaved repetitions, or over seeds of the picture.
struct Spread {
  double median = 0, least = 0, most = 0;
  std::vector<double> samples{};  ///< in order: sample i of one level and sample i of another are a pair

  static Spread of(std::vector<double> samples);
};

/// One cost over another, with an interval of 95 %.
struct CostRatio {
  double ratio = 1, low = 1, high = 1;

  /// The costs cannot be told apart.
  bool ties() const { return low <= 1 && high >= 1; }
};
/// By pairs of samples: the mean of the logarithms of their ratios, and the interval of Student's distribution. Where
/// there are no two pairs, the ratio of the medians, and the interval that the ranges allow.
CostRatio cost_ratio(const Spread& a, const Spread& b);

/// The answers of one level compared with the exact ones.
struct HitErrors {
  std::uint64_t rays = 0;
  std::uint64_t missed = 0;  ///< a miss where the exact ray hits
  std::uint64_t extra = 0;   ///< a hit where the exact ray misses
  std::uint64_t other = 0;   ///< another primitive, and no exact tie: at an edge, a neighbour as a rule
  /// Rays that stop at, or pass, a non-opaque surface only because u and v are rounded where its opacity is looked up:
  /// those above are counted as if it had been looked up at the exact point.
  std::uint64_t opacity = 0;
  double ulp_median = 0, ulp_p99 = 0, ulp_max = 0;  ///< error of t, where both hit the same primitive

  std::uint64_t wrong() const { return missed + extra; }
};

/// A picture compared with the exact one, in linear values.
struct PictureErrors {
  std::uint64_t pixels = 0, differ = 0;
  double rmse = 0;   ///< root mean square error over all channels
  double worst = 0;  ///< greatest error of a channel of a pixel
};

/// Rays that are hard to answer correctly.
struct HardCase {
  std::string name, what;
  bool closed = false;  ///< every ray starts inside a closed surface: a miss is a leak
  bool slivers =
      false;  ///< its triangles are so thin that a rounded test may lose them, though their mesh stays closed
};

/// The configured machine with all but its test units relaxed.
struct TesterLimited {
  double cycles_per_ray = 0;
  std::string busiest;            ///< the kind of units that was busy most
  double busy_fraction = 0;       ///< part of the cycles, in the mean of the resources
  std::vector<double> by_seed{};  ///< cycles a ray of each seed of the picture
};

/// The cost on simulated machines, by the cycle engine.
struct ModelledCost {
  double cycles_per_ray = 0;         ///< as configured
  std::vector<double> by_seed{};     ///< cycles a ray of each seed of the picture
  double tester_cycles_per_ray = 0;  ///< cycles in which a resource's test units of a kind were busy
  double energy_pj_per_ray = 0;      ///< energy of the tests' products and sums
  double exact_volumes_per_ray = 0, bundle_tests_per_ray = 0, plane_tests_per_ray = 0;
  std::optional<TesterLimited> tester_limited{};
};

/// The two clocks by which a level has its cost: time of this host, cycles of the machine in which the testers limit.
enum class Clock : std::uint8_t { kHost, kHardware };
inline constexpr std::array<Clock, 2> kClocks{Clock::kHost, Clock::kHardware};
template <class T>
using PerClock = std::array<T, 2>;

/// One combination of levels of the tests.
struct AccuracyRow {
  std::string triangle, box, transform;
  Spread ns_per_ray;                     ///< CPU time of one thread, depth-first
  std::optional<ModelledCost> modelled;  ///< absent if the cycle engine cannot run the configured machine
  HitErrors scene;
  std::vector<HitErrors> hard;  ///< by Accuracy::hard
  PictureErrors picture;
  std::uint64_t leaks = 0;  ///< misses in all closed cases
  /// Area of a resource's units, and its ratio to that of the default levels.
  double unit_area_mm2 = 0, relative_area = 0;
  bool cull_planes = false;                            ///< the configured cull planes were tested
  PerClock<bool> frontier{};                           ///< no other row is both cheaper and less often wrong
  PerClock<std::optional<CostRatio>> over_cheapest{};  ///< the cost over that of the cheapest row
  bool safe = false;                                   ///< nothing missed or added, in the scene and in all hard cases
  bool safe_but_slivers = false;                       ///< as `safe`, but for the hard cases of slivers

  bool on_frontier(Clock clock) const { return frontier[static_cast<std::size_t>(clock)]; }
  /// The cost by a clock, with its range; empty if it was not measured.
  std::optional<Spread> cost(Clock clock) const;

  std::uint64_t wrong() const {
    std::uint64_t sum = scene.wrong();
    for (const HitErrors& errors : hard) sum += errors.wrong();
    return sum;
  }
};

struct SpawnRow {
  std::string spawn;
  std::uint64_t bounces = 0;                           ///< rays that left a triangle
  std::uint64_t self_hits = 0;                         ///< rays of these that hit the same triangle again
  std::uint64_t hard_bounces = 0, hard_self_hits = 0;  ///< such rays from instances far from the origin
  PictureErrors picture;
};

struct SamplingRow {
  std::uint64_t samples = 0;
  double rmse = 0, seconds = 0;  ///< without the 2 % farthest off, in [0, 1]; the means over several seeds
};

/// The report of `carousel accuracy`.
struct Accuracy {
  std::string scene;
  std::uint64_t triangles = 0, instances = 0, rays = 0, seed = 0;
  std::uint64_t width = 0, height = 0, samples = 0;  ///< size of the pictures
  int repetitions = 0;
  int seeds = 0;  ///< number of the picture's seeds, over which the machines' cycles are measured
  std::vector<HardCase> hard;
  std::vector<AccuracyRow> rows;
  std::vector<SpawnRow> spawn;
  std::vector<SamplingRow> sampling;
  double sampling_slope = 0;  ///< slope of log RMSE over log samples; Monte Carlo has -1/2
  std::string verdict;        ///< the cheapest safe level, in a sentence
  std::string machine;
  bool incomplete = false;                             ///< it was interrupted
  bool planes = false, bundles = false;                ///< the configuration has them
  PerClock<std::optional<std::size_t>> recommended{};  ///< index of the row, by clock
};

/// Sets `safe` and `safe_but_slivers` by the row's errors.
void judge_safety(AccuracyRow& row, const std::vector<HardCase>& hard);

// Costs are compared in pairs, of the same repetition or the same seed of the picture; those that cannot be told apart
// (cost_ratio()) are equal.

/// Sets `over_cheapest`.
void compare_costs(std::vector<AccuracyRow>& rows);
/// Marks the frontiers: rows than which no other is cheaper and not more often wrong, or less often wrong and not
/// dearer.
void mark_frontier(std::vector<AccuracyRow>& rows);
/// The cheapest safe row. Among rows that cost the same, it is one whose t is as accurate as the best of them (99th
/// percentile, within a tenth); of these one with the smallest units, and of these the first, which is the simplest.
/// accuracy_verdict() names the ties.
std::optional<std::size_t> recommended(const std::vector<AccuracyRow>& rows, Clock clock);
/// The row of the least cost, whatever it gets wrong; empty if no cost was measured by this clock.
std::optional<std::size_t> cheapest_level(const std::vector<AccuracyRow>& rows, Clock clock);
/// The sentences for `verdict`, for the host and for hardware: the recommended row, the price over the cheapest of all,
/// and what that one and the cheapest that loses nothing but slivers get wrong.
std::string accuracy_verdict(const std::vector<AccuracyRow>& rows);
/// Least-squares slope of log(rmse) over log(samples); rows with an RMSE of 0 do not count. 0 for fewer than two.
double log_log_slope(const std::vector<SamplingRow>& rows);

}  // namespace carousel::report
