#include "ringbus/sampling/sample_estimate.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "ringbus/cycle/messages/memory_messages.h"
#include "ringbus/sampling/frame_lines.h"
#include "ringbus/verdict/bottleneck_search.h"
#include "ringbus/verdict/progress_blocks.h"
#include "ringbus/verdict/steady_state.h"

namespace carousel::ringbus {

namespace {

/// Standard errors to either side that hold 95 %, of Student's distribution with as many degrees of freedom as there
/// are neighbours to compare.
constexpr double kErrors = 2.13;
/// The part of the time that warm caches spare that is in doubt.
constexpr double kUnsure = 0.5;

Estimate around(double value, double error) {
  return {value, std::max(0.0, value - error), value + error};
}

double over(double a, double b) {
  return b > 0 ? a / b : 0;
}

/// a / b, with the relative errors of both, as if they were independent.
Estimate quotient(double value, double relative_a, double relative_b) {
  return around(value, value * std::hypot(relative_a, relative_b));
}

double link_bytes(const RunResult& result) {
  double bytes = 0;
  for (const cycle::LinkUse& link : result.cycle->links) bytes += static_cast<double>(link.bytes);
  return bytes;
}

IntersectionCounts tests_of(const RunResult& result) {
  IntersectionCounts sum;
  for (const ResourceStatistics& resource : result.resources) sum += resource.tests;
  return sum;
}

bool of_memory(std::string_view name) {
  return name == "memory_bandwidth" || name == "l2_port";
}

class Sample {
 public:
  Sample(const Config& config, const SampleRun& run)
      : config_(config),
        run_(run),
        c_(*run.result.cycle),
        rays_(static_cast<double>(run.result.rays_completed)),
        times_(static_cast<double>(run.frame_paths) / static_cast<double>(run.paths)),
        unseen_(std::sqrt(std::max(0.0, 1 - 1 / times_))) {
    const std::uint64_t n = run.result.rays_completed;
    begin_ = std::min(fill_rays(slots_of(config)), n / 4);
    end_ = c_.all_begun ? c_.all_begun->completed : n;
    too_small_ = end_ < begin_ + n / 4;
    if (too_small_) begin_ = 0, end_ = n;
    lines_.emplace(config, run, FrameLines::Window{begin_, end_}, times_);
  }

  FrameValues estimate() const {
    FrameValues out;
    const double rays_error = error_of_rays(), time_error = error_of_time();
    const double rest = (times_ - 1) * rays_, spared = rest * spared_cycles_a_ray();
    const double cycles = static_cast<double>(c_.cycles) + rest * cycles_a_ray() - spared;
    const double each = cycles / (times_ * rays_), unsure = kUnsure * spared / (times_ * rays_);
    out.rays = around(times_ * rays_, times_ * rays_ * rays_error);
    out.cycles_per_ray = around(each, each * time_error + unsure);
    if (too_small_) out.cycles_per_ray.low = std::min(out.cycles_per_ray.low, least_cycles_a_ray() * (1 - time_error));
    out.cycles = quotient(cycles, time_error + unsure / each, rays_error);
    if (too_small_) out.cycles.low = out.cycles_per_ray.low * out.rays.low;
    for (Estimate* e : {&out.cycles_per_ray, &out.cycles}) e->low = std::max(0.0, e->low - e->value * imbalance());
    const Estimate& e = out.cycles_per_ray;
    out.rays_per_kilocycle = {over(1000, e.value), over(1000, e.high), over(1000, e.low)};
    const IntersectionCounts tests = tests_of(run_.result);
    out.box_tests_per_ray = per_ray(static_cast<double>(tests.box), "box_tests");
    out.triangle_tests_per_ray = per_ray(static_cast<double>(tests.triangle), "triangle_tests");
    out.link_bytes_per_ray = per_ray(link_bytes(run_.result), "link_bandwidth");
    const auto moved = class_of("memory_bandwidth");
    const Estimate lines = lines_->frame(moved ? error_of_work(*moved, false) : 0);
    const double line = static_cast<double>(cycle::fetched_bytes(config_.memory)) / out.rays.value;
    // Lines that are asked for once are as many whether the frame has more rays or fewer than was estimated.
    const double once = rays_error * std::min(1.0, over(lines_->frame_first().value, lines.value));
    out.memory_bytes_per_ray = {lines.value * line, lines.low * line * (1 - once), lines.high * line * (1 + once)};
    for (std::size_t i = 0; i < c_.uses.size(); ++i)
      if (c_.uses[i].busy > 0) out.uses.push_back({c_.uses[i].name, use(i, cycles, lines)});
    out.steady = over(static_cast<double>(end_ - begin_), rays_);
    out.too_small = too_small_;
    return out;
  }

 private:
  /// The part of the run's tests that had been done; without tests, of its rays that had been completed.
  double tested(const cycle::ProgressSample& sample) const {
    double part = 0;
    int classes = 0;
    for (const std::string_view name : {"box_tests", "triangle_tests"}) {
      const auto i = class_of(name);
      if (!i || c_.uses[*i].busy == 0) continue;
      part += static_cast<double>(sample.busy[*i]) / static_cast<double>(c_.uses[*i].busy);
      ++classes;
    }
    return classes > 0 ? part / classes : static_cast<double>(sample.completed) / rays_;
  }

  /// The time of a ray between fill and drain.
  double cycles_a_ray() const {
    if (too_small_) return static_cast<double>(c_.cycles) / rays_;
    const auto part = [this](const cycle::ProgressSample& s) { return tested(s); };
    const double time = at_count(c_, end_, cycle_of) - at_count(c_, begin_, cycle_of);
    const double work = at_count(c_, end_, part) - at_count(c_, begin_, part);
    return time / rays_ / work;
  }

  /// The time of a ray that the rest of the frame spares, as the testers wait less often for lines that no ray has
  /// asked for before.
  double spared_cycles_a_ray() const {
    const double first = lines_->first();
    if (first <= 0) return 0;
    Cycle waits = 0;
    for (const cycle::TileResult& tile : c_.tiles) waits += tile.states[std::size_t(cycle::TileState::kMemory)];
    const double wait = double(waits) / double(c_.tiles.size());
    const auto memory = static_cast<double>(config_.memory.dram_latency_cycles);
    double latencies = lines_->sample() * memory;
    for (const CacheCounts& cache : c_.caches)
      latencies += double(cache.requests) * double(config_.memory.l2_latency_cycles);
    if (c_.own_caches)
      latencies += static_cast<double>(c_.own_caches->requests) * static_cast<double>(config_.memory.l1_latency_cycles);
    const double cold = latencies > 0 ? wait * first * memory / latencies / rays_ : 0;
    const double fewer = 1 - std::min(1.0, (lines_->frame_first().value / first - 1) / std::max(1e-9, times_ - 1));
    return std::min(cold * fewer, cycles_a_ray() / 2);
  }

  /// The class whose parts are most of the time at work, other than those of the memory, which are busier while caches
  /// are cold.
  std::size_t busiest() const {
    std::size_t best = 0;
    double most = -1;
    for (std::size_t i = 0; i < c_.uses.size(); ++i) {
      const cycle::ClassUse& use = c_.uses[i];
      const double busy = use.parts > 0 && !of_memory(use.name) ? static_cast<double>(use.busy) / use.parts : 0;
      if (busy > most) most = busy, best = i;
    }
    return best;
  }

  /// By how much the resource with most tests has more than the mean. A sample is short enough for one resource to work
  /// on while others have run out of rays; in the frame they catch up.
  double imbalance() const {
    std::uint64_t most = 0, all = 0;
    for (const ResourceStatistics& resource : run_.result.resources) {
      most = std::max(most, resource.tests.box + resource.tests.triangle);
      all += resource.tests.box + resource.tests.triangle;
    }
    const auto parts = static_cast<double>(run_.result.resources.size()) -
                       static_cast<double>(managers_of(config_.topology));  // which test nothing
    return all > 0 ? parts * static_cast<double>(most) / static_cast<double>(all) - 1 : 0;
  }

  /// The time of a ray if the busiest class had no pause.
  double least_cycles_a_ray() const {
    const cycle::ClassUse& use = c_.uses[busiest()];
    return static_cast<double>(use.busy) / use.parts / rays_;
  }

  /// Relative error of the time a ray, whose tests are nearly those of the frame: that of the time a test.
  double error_of_time() const {
    const auto part = [this](const cycle::ProgressSample& s) { return tested(s); };
    std::vector<double> time = block_means(c_, begin_, end_, cycle_of);
    const std::vector<double> work = block_means(c_, begin_, end_, part);
    const double all = time.back() - time.front(), each = over(all, work.back() - work.front());
    for (std::size_t i = 0; i < time.size(); ++i) time[i] -= each * work[i];
    return unseen_ * kErrors * over(standard_error(steps(time)), all);
  }

  /// Relative error of the rays a path: a ratio of sums over places.
  double error_of_rays() const {
    const double each = rays_ / static_cast<double>(run_.paths);
    const std::size_t places = run_.paths_of.size();
    if (places < 2) return 1;
    double squares = 0, before = 0;
    for (std::size_t i = 0; i < places; ++i) {
      const double rest = static_cast<double>(run_.rays_of[i]) - each * static_cast<double>(run_.paths_of[i]);
      if (i > 0) squares += (rest - before) * (rest - before);
      before = rest;
    }
    return unseen_ * kErrors * std::sqrt(double(places) / double(places - 1) * squares / 2) / rays_;
  }

  std::optional<std::size_t> class_of(std::string_view name) const {
    for (std::size_t i = 0; i < c_.uses.size(); ++i)
      if (c_.uses[i].name == name) return i;
    return std::nullopt;
  }

  /// Relative error of the work of a class a ray, or of that over its time.
  double error_of_work(std::size_t i, bool over_time) const {
    const auto busy = [i](const cycle::ProgressSample& s) { return static_cast<double>(s.busy[i]); };
    const std::vector<double> work = block_means(c_, begin_, end_, busy),
                              time = block_means(c_, begin_, end_, cycle_of);
    const double all = work.back() - work.front();
    if (!(all > 0)) return 0;
    std::vector<double> terms = work;
    if (over_time)
      for (std::size_t k = 0; k < terms.size(); ++k) terms[k] -= all / (time.back() - time.front()) * time[k];
    return unseen_ * kErrors * standard_error(steps(terms)) / all;
  }

  Estimate per_ray(double count, std::string_view name) const {
    const auto i = class_of(name);
    return around(count / rays_, i ? count / rays_ * error_of_work(*i, false) : 0);
  }

  Estimate use(std::size_t i, double cycles, const Estimate& lines) const {
    const cycle::ClassUse& use = c_.uses[i];
    const double busy = static_cast<double>(use.busy), available = use.parts * cycles;
    const double requests = static_cast<double>(run_.memory.size());
    Estimate out;
    if (use.name == "memory_bandwidth" && requests > 0) {
      const double each = busy / requests / available;
      out = {each * lines.value, each * lines.low, each * lines.high};
    } else {
      out = around(busy * times_ / available, busy * times_ / available * error_of_work(i, true));
    }
    return {std::min(1.0, out.value), std::min(1.0, out.low), std::min(1.0, out.high)};
  }

  const Config& config_;
  const SampleRun& run_;
  const cycle::CycleResult& c_;
  double rays_, times_, unseen_;
  std::uint64_t begin_ = 0, end_ = 0;
  bool too_small_ = false;
  std::optional<FrameLines> lines_;
};

Estimate exactly(double value) {
  return {value, value, value};
}

}  // namespace

FrameValues exact_values(const Config& config, const RunResult& result) {
  const cycle::CycleResult& c = *result.cycle;
  const double rays = static_cast<double>(result.rays_completed), cycles = static_cast<double>(c.cycles);
  const IntersectionCounts tests = tests_of(result);
  const auto per_ray = [&](double count) { return exactly(over(count, rays)); };
  FrameValues out;
  out.rays = exactly(rays);
  out.cycles = exactly(cycles);
  out.cycles_per_ray = per_ray(cycles);
  out.rays_per_kilocycle = exactly(over(1000 * rays, cycles));
  out.box_tests_per_ray = per_ray(static_cast<double>(tests.box));
  out.triangle_tests_per_ray = per_ray(static_cast<double>(tests.triangle));
  out.link_bytes_per_ray = per_ray(link_bytes(result));
  out.memory_bytes_per_ray =
      per_ray(static_cast<double>((c.memory.lines + c.memory.lines_written) * cycle::fetched_bytes(config.memory)));
  for (const cycle::ClassUse& use : c.uses)
    if (use.busy > 0) out.uses.push_back({use.name, exactly(over(static_cast<double>(use.busy), use.parts * cycles))});
  return out;
}

FrameValues estimate_frame(const Config& config, const SampleRun& run) {
  return Sample(config, run).estimate();
}

}  // namespace carousel::ringbus
