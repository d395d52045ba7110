#include "ringbus/verdict/steady_state.h"

#include <algorithm>

namespace carousel::ringbus {

std::optional<SteadyState> steady_state(const cycle::CycleResult& result, std::uint64_t rays, std::uint64_t slots) {
  constexpr double kLeastShare = 0.5, kSameMix = 0.75;
  if (!result.all_begun) return std::nullopt;
  const cycle::ProgressSample& end = *result.all_begun;
  const auto begin = std::find_if(result.progress.begin(), result.progress.end(),
                                  [&](const auto& sample) { return sample.completed >= fill_rays(slots); });
  if (begin == result.progress.end() || begin->at >= end.at) return std::nullopt;
  const double of_rays = static_cast<double>(end.completed - begin->completed) / static_cast<double>(rays);
  if (of_rays < kLeastShare) return std::nullopt;
  double busiest = 0;
  for (const cycle::ClassUse& use : result.uses) busiest = std::max(busiest, static_cast<double>(use.busy) / use.parts);
  SteadyState out{end.at - begin->at, of_rays};
  for (std::size_t i = 0; i < result.uses.size(); ++i) {
    const cycle::ClassUse& use = result.uses[i];
    if (2 * static_cast<double>(use.busy) / use.parts < busiest) continue;
    out.share = std::min(out.share, static_cast<double>(end.busy[i] - begin->busy[i]) / static_cast<double>(use.busy));
  }
  if (out.share < kSameMix * of_rays) return std::nullopt;
  return out;
}

}  // namespace carousel::ringbus
