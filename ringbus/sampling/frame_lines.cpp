#include "ringbus/sampling/frame_lines.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "ringbus/cycle/messages/memory_messages.h"
#include "ringbus/verdict/progress_blocks.h"

namespace carousel::ringbus {

namespace {

/// The lower bound leaves out this part of the lines that the frame touches and the sample does not.
constexpr double kUnsureTouches = 0.4;

/// a of the distribution, the sample's rays being 1: log(1 + a) / log(1 + a / 2) falls from 2 to 1.
double rate_for(double ratio) {
  double low = 1e-6, high = 1e12;
  for (int i = 0; i < 100; ++i) {
    const double a = std::sqrt(low * high);
    (std::log1p(a) / std::log1p(a / 2) > ratio ? low : high) = a;
  }
  return std::sqrt(low * high);
}

/// The part of the requests for replaced lines that is in doubt, as caches may still be filling.
constexpr double kWarming = 0.3;
/// Conflicts in a set, and lines that are fetched twice for a moment, as a part of all lines.
constexpr double kRounding = 0.02;

}  // namespace

Estimate first_touches(double in_half, double in_sample, double lines, double times) {
  if (in_sample <= 0 || in_sample >= lines) return {in_sample, in_sample, in_sample};
  const double left = -std::log1p(-in_sample / lines);  // touches of a line, if all lines have equal rates
  const double most = -lines * std::expm1(-left * times);
  const double half = -std::log1p(-std::clamp(in_half, 1.0, std::max(1.0, 0.999 * in_sample)) / lines);
  double value = most;
  if (left / half < 2) {
    const double a = rate_for(left / half), k = left / std::log1p(a);
    value = -lines * std::expm1(-k * std::log1p(a * times));
  }
  value = std::clamp(value, in_sample, most);
  return {value, value - kUnsureTouches * (value - in_sample), most};
}

FrameLines::FrameLines(const Config& config, const SampleRun& run, Window window, double times)
    : times_(times), rays_(static_cast<double>(run.result.rays_completed)) {
  const cycle::CycleResult& c = *run.result.cycle;
  const std::uint64_t middle = window.begin + (window.end - window.begin) / 2;
  const double half = at_count(c, run.result.rays_completed / 2, cycle_of), late = at_count(c, middle, cycle_of),
               last = at_count(c, window.end, cycle_of);
  const std::size_t caches = std::max<std::size_t>(1, c.caches.size());
  std::unordered_map<std::uint64_t, std::size_t> seen;
  double first_half = 0;
  for (const MemoryRequest& request : run.memory) {
    const auto at = static_cast<double>(request.cycle);
    const bool shape = request.address < run.shape_bytes && !request.write;
    const bool first = shape && seen[request.address]++ < caches;
    (first ? first_ : shape ? again_ : other_) += 1;
    if (first && at <= half) ++first_half;
    if (shape && at > late && at <= last) (first ? late_first_ : late_again_) += 1;
  }
  late_rays_ = static_cast<double>(window.end - middle);
  const auto line = static_cast<double>(cycle::fetched_bytes(config.memory)), all = static_cast<double>(caches);
  cached_ = all * 1024 * static_cast<double>(config.memory.l2_kib) / line;
  frame_first_ = first_touches(first_half, first_, all * std::ceil(static_cast<double>(run.shape_bytes) / line), times);
}

Estimate FrameLines::frame(double error) const {
  const double rest = (times_ - 1) * rays_, late = late_first_ + late_again_;
  const auto of_rest = [&](double count) { return late_rays_ > 0 ? rest * count / late_rays_ : 0; };
  const double again = of_rest(late_again_), steady = of_rest(late);
  // Requests of the frame with `first` lines. A part of those requests of the later half that a warm cache would spare
  // comes again, too.
  const auto with = [&](double first, double part) {
    const double more = first - first_ + again;
    return first_ + again_ + more + part * std::max(0.0, steady - more);
  };
  const double replaced = late > 0 ? late_again_ / late : 0, most = frame_first_.high;
  const double overrun = most > 0 ? std::clamp(2 * (1 - cached_ / most), replaced, 1.0) : 0;
  const double others = times_ * other_, unsure = error * (again + others) + kWarming * again;
  const double value = with(frame_first_.value, replaced) + others, rounding = kRounding * value;
  return {value, std::max(sample(), with(frame_first_.low, 0) + others - unsure - rounding),
          with(most, overrun) + others + unsure + rounding};
}

}  // namespace carousel::ringbus
