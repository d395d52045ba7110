#include "ringbus/verdict/foretell.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "ringbus/verdict/progress_blocks.h"

namespace carousel::ringbus {

namespace {

std::uint64_t drain_begins(const PilotRun& run) {
  return run.result->all_begun ? run.result->all_begun->completed : run.rays;
}

}  // namespace

Foretelling::Foretelling(PilotRun base, std::uint64_t frame_rays, std::uint64_t fill)
    : base_(base), frame_rays_(frame_rays), fill_(std::min(fill, base.rays / 4)) {}

Foretelling::Window Foretelling::window(PilotRun other) const {
  const std::uint64_t end = std::min(drain_begins(base_), drain_begins(other));
  // A pilot that is never between fill and drain can only be taken as a whole.
  if (end < fill_ + base_.rays / 4) return {0, base_.rays};
  return {fill_, end};
}

double Foretelling::per_ray(const cycle::CycleResult& result, Window window) {
  const std::vector<double> means = block_means(result, window.begin, window.end, cycle_of);
  return (means.back() - means.front()) /
         (static_cast<double>(window.rays()) * (kProgressBlocks - 1) / kProgressBlocks);
}

double Foretelling::frame_cycles(PilotRun run, Window window) const {
  const double all = static_cast<double>(run.result->cycles);
  if (whole()) return all;
  const double each = window.rays() >= run.rays ? all / static_cast<double>(run.rays) : per_ray(*run.result, window);
  return all + static_cast<double>(frame_rays_ - run.rays) * each;
}

Estimate Foretelling::cycles() const {
  const Window w = window(base_);
  const double value = frame_cycles(base_, w);
  if (whole()) return {value, value, value};
  const std::vector<double> means = block_means(*base_.result, w.begin, w.end, cycle_of);
  const double error = 2 * standard_error(steps(means)) / std::max(1.0, means.back() - means.front()) * value;
  return {value, value - error, value + error};
}

std::vector<double> Foretelling::busy() const {
  std::vector<double> out;
  const Window w = window(base_);
  const cycle::CycleResult& result = *base_.result;
  for (std::size_t i = 0; i < result.uses.size(); ++i) {
    const auto value = [i](const cycle::ProgressSample& s) { return static_cast<double>(s.busy[i]); };
    double all = static_cast<double>(result.uses[i].busy);
    if (!whole())
      all += static_cast<double>(frame_rays_ - base_.rays) *
             (at_count(result, w.end, value) - at_count(result, w.begin, value)) / static_cast<double>(w.rays());
    out.push_back(all);
  }
  return out;
}

/// By how much longer the base takes from each block to the next than the other machine, scaled to the same sum, as a
/// fraction of the other's time.
std::vector<double> Foretelling::differences(PilotRun other, Window window) const {
  const std::vector<double> base = block_means(*base_.result, window.begin, window.end, cycle_of),
                            rest = block_means(*other.result, window.begin, window.end, cycle_of);
  const double all = std::max(1.0, rest.back() - rest.front()), ratio = (base.back() - base.front()) / all;
  std::vector<double> d;
  for (std::size_t i = 0; i < kProgressBlocks; ++i) d.push_back((base[i] - ratio * rest[i]) / all);
  return steps(d);
}

Estimate Foretelling::gain(PilotRun relaxed, double deviation, bool warms) const {
  const auto gain_by = [&](Window w) { return frame_cycles(base_, w) / frame_cycles(relaxed, w) - 1; };
  Window w = window(relaxed);
  std::vector<double> d = differences(relaxed, w);
  double still = 0;  // that it may yet gain
  const auto middle = d.begin() + static_cast<std::ptrdiff_t>(d.size() / 2);
  if (const double grown = std::accumulate(middle, d.end(), 0.0) - std::accumulate(d.begin(), middle, 0.0);
      warms && !whole() && grown > 2 * standard_error(d)) {
    const Window earlier{w.begin, w.begin + w.rays() / 2};
    w.begin = earlier.end;
    still = std::max(0.0, gain_by(w) - gain_by(earlier));
    d = differences(relaxed, w);
  }
  const double gain = gain_by(w), of_frame = static_cast<double>(w.rays()) / static_cast<double>(frame_rays_),
               off = whole() ? 0 : std::abs(deviation) * (1 + gain) * (1 + gain) / 2,
               half = 2 * standard_error(d) * std::sqrt(1 + of_frame) + off;
  return {gain, gain - half, gain + half + still};
}

}  // namespace carousel::ringbus
