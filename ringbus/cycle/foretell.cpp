#include "ringbus/cycle/foretell.h"

#include <algorithm>
#include <cmath>
#include <span>

namespace carousel::ringbus {

namespace {

constexpr std::size_t kBlocks = 16;

/// The value at which `completed` rays had been completed, between samples by a straight line; `value` takes a sample.
template <class Value>
double at_count(const cycle::CycleResult& result, std::uint64_t completed, const Value& value) {
  const std::vector<cycle::ProgressSample>& all = result.progress;
  const auto after = std::find_if(all.begin(), all.end(), [&](const auto& s) { return s.completed >= completed; });
  if (after == all.end()) return all.empty() ? 0 : value(all.back());
  const double reached = value(*after);
  if (after == all.begin()) return reached;
  const cycle::ProgressSample& before = *(after - 1);
  const double part =
      static_cast<double>(completed - before.completed) / static_cast<double>(after->completed - before.completed);
  return value(before) + part * (reached - value(before));
}

double cycle_at(const cycle::CycleResult& result, std::uint64_t completed) {
  return at_count(result, completed, [](const cycle::ProgressSample& s) { return static_cast<double>(s.at); });
}

/// The mean cycle of completion in each of the blocks of equal numbers of rays that the window is cut into. Times at
/// which two schedules complete the same number of rays differ by chance; their means differ less.
std::vector<double> block_means(const cycle::CycleResult& result, std::uint64_t begin, std::uint64_t end) {
  constexpr std::uint64_t kLooks = 16;
  std::vector<double> out;
  for (std::size_t block = 0; block < kBlocks; ++block) {
    double sum = 0;
    for (std::uint64_t look = 0; look < kLooks; ++look)
      sum += cycle_at(result, begin + (end - begin) * (2 * (block * kLooks + look) + 1) / (2 * kBlocks * kLooks));
    out.push_back(sum / static_cast<double>(kLooks));
  }
  return out;
}

std::vector<double> steps(const std::vector<double>& values) {
  std::vector<double> out;
  for (std::size_t i = 1; i < values.size(); ++i) out.push_back(values[i] - values[i - 1]);
  return out;
}

std::uint64_t drain_begins(const PilotRun& run) {
  return run.result->all_begun ? run.result->all_begun->completed : run.rays;
}

/// The standard error of the sum of steps between block means, from the differences between neighbours. If rays take
/// their times independently of each other, with a variance of v for a block, steps have a variance of 2/3 v and, as
/// neighbours share half a block, a covariance of 1/6 v; the squared differences then come to v, as does a step's part
/// of the variance of the sum.
double standard_error(std::span<const double> terms) {
  if (terms.size() < 2) return 0;
  double squares = 0;
  for (std::size_t i = 1; i < terms.size(); ++i) squares += (terms[i] - terms[i - 1]) * (terms[i] - terms[i - 1]);
  const double n = static_cast<double>(terms.size());
  return std::sqrt(n / (n - 1) * squares);
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
  const std::vector<double> means = block_means(result, window.begin, window.end);
  return (means.back() - means.front()) / (static_cast<double>(window.rays()) * (kBlocks - 1) / kBlocks);
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
  const std::vector<double> means = block_means(*base_.result, w.begin, w.end);
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

Estimate Foretelling::gain(PilotRun relaxed, double deviation) const {
  const Window w = window(relaxed);
  const double ratio = frame_cycles(base_, w) / frame_cycles(relaxed, w), gain = ratio - 1;
  if (whole()) return {gain, gain, gain};
  const std::vector<double> base = block_means(*base_.result, w.begin, w.end),
                            other = block_means(*relaxed.result, w.begin, w.end);
  const double all = std::max(1.0, other.back() - other.front()), of_window = (base.back() - base.front()) / all;
  std::vector<double> d;
  for (std::size_t i = 0; i < kBlocks; ++i) d.push_back(base[i] - of_window * other[i]);
  d = steps(d);
  const double half = 2 * standard_error(d) / all + std::abs(deviation) * ratio * ratio / 2;
  return {gain, gain - half, gain + half};
}

}  // namespace carousel::ringbus
