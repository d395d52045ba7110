#include "ringbus/verdict/small_frame.h"

#include <algorithm>
#include <cmath>

#include "ringbus/verdict/steady_state.h"

namespace carousel::ringbus {

namespace {

constexpr double kLeastBetween = 0.75;

}  // namespace

std::uint64_t two_digits_up(double value) {
  const double unit = std::pow(10, std::max(0.0, std::floor(std::log10(std::max(1.0, value))) - 1));
  return static_cast<std::uint64_t>(std::ceil(value / unit) * unit);
}

double part_between(const cycle::CycleResult& result, std::uint64_t rays, std::uint64_t slots) {
  if (!result.all_begun || rays == 0) return 0;
  const std::uint64_t begun = result.all_begun->completed, filled = fill_rays(slots);
  return begun > filled ? static_cast<double>(begun - filled) / static_cast<double>(rays) : 0;
}

std::optional<SmallFrame> small_frame(const cycle::CycleResult& result, std::uint64_t rays, std::uint64_t paths,
                                      std::uint64_t slots) {
  if (!result.all_begun || rays == 0 || paths == 0) return std::nullopt;
  const std::uint64_t begun = result.all_begun->completed, filled = fill_rays(slots);
  const double all = static_cast<double>(rays), between = part_between(result, rays, slots);
  if (between >= kLeastBetween) return std::nullopt;
  // A machine that was never full has less to drain than a full one.
  const double each = all / static_cast<double>(paths),
               drained =
                   std::max(static_cast<double>(rays - begun), paths < slots ? each * static_cast<double>(slots) : 0.0),
               least = (static_cast<double>(filled) + drained) / (1 - kLeastBetween);
  return SmallFrame{paths, slots, between, two_digits_up(least / each)};
}

}  // namespace carousel::ringbus
