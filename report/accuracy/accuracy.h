#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace carousel::report {

/// A measurement over interleaved repetitions.
struct Spread {
  double median = 0, least = 0, most = 0;
};

/// The answers of one level compared with the exact ones.
struct HitErrors {
  std::uint64_t rays = 0;
  std::uint64_t missed = 0;  ///< a miss where the exact ray hits
  std::uint64_t extra = 0;   ///< a hit where the exact ray misses
  std::uint64_t other = 0;   ///< another triangle, and no exact tie: at an edge, a neighbour as a rule
  double ulp_median = 0, ulp_p99 = 0, ulp_max = 0;  ///< of t, where both hit the same triangle

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
};

/// The cost on the configured machine, by the cycle engine.
struct ModelledCost {
  double cycles_per_ray = 0;
  double tester_cycles_per_ray = 0;  ///< cycles in which a resource's box, triangle or transform units were busy
};

/// One combination of levels of the tests.
struct AccuracyRow {
  std::string triangle, box, transform;
  Spread ns_per_ray;                     ///< CPU time of one thread, depth-first
  std::optional<ModelledCost> modelled;  ///< absent if the cycle engine cannot run the configured machine
  HitErrors scene;
  std::vector<HitErrors> hard;  ///< by Accuracy::hard
  PictureErrors picture;
  std::uint64_t leaks = 0;  ///< misses in all closed cases
  bool frontier = false;    ///< no other row is both faster and less often wrong
  bool safe = false;        ///< no leak, and nothing missed or added in the scene

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
  std::uint64_t hard_bounces = 0, hard_self_hits = 0;  ///< the same from instances far from the origin
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
  std::vector<HardCase> hard;
  std::vector<AccuracyRow> rows;
  std::vector<SpawnRow> spawn;
  std::vector<SamplingRow> sampling;
  double sampling_slope = 0;  ///< of log RMSE over log samples; Monte Carlo has -1/2
  std::string verdict;        ///< the cheapest safe level, in a sentence
  std::string machine;
  bool incomplete = false;  ///< it was interrupted
};

/// Marks the frontier: rows than which no other is faster (by the median) and not more often wrong, or less often
/// wrong and not slower.
void mark_frontier(std::vector<AccuracyRow>& rows);
/// The sentence for `verdict`: which safe row is the fastest, and what the fastest of all gets wrong.
std::string accuracy_verdict(const std::vector<AccuracyRow>& rows);
/// Least-squares slope of log(rmse) over log(samples); rows with an RMSE of 0 do not count. 0 for fewer than two.
double log_log_slope(const std::vector<SamplingRow>& rows);

}  // namespace carousel::report
