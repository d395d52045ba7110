#include "shading/lights/light_choice.h"

#include <algorithm>

namespace carousel::shading {

LightChoice::LightChoice(std::span<const float> weights, unsigned bits) {
  double total = 0;
  for (const float w : weights) total += double{w};
  if (!(total > 0.0)) return;
  thresholds_.reserve(weights.size());
  const std::uint32_t steps = ~std::uint32_t{0} << (32 - bits);
  double sum = 0;
  for (const float w : weights) {
    thresholds_.push_back(static_cast<std::uint32_t>(std::min(sum / total * 0x1p32, 0x1p32 - 1)) & steps);
    sum += double{w};
  }
}

std::uint32_t LightChoice::choose(std::uint32_t word) const {
  // The last of several equal thresholds owns the words; the others own none.
  return static_cast<std::uint32_t>(std::upper_bound(thresholds_.begin(), thresholds_.end(), word) -
                                    thresholds_.begin() - 1);
}

std::pair<std::uint64_t, std::uint64_t> LightChoice::words_of(std::uint32_t item) const {
  if (item >= thresholds_.size()) return {std::uint64_t{1} << 32, std::uint64_t{1} << 32};
  const std::uint64_t end = item + 1 < thresholds_.size() ? thresholds_[item + 1] : std::uint64_t{1} << 32;
  return {thresholds_[item], end};
}

float LightChoice::probability(std::uint32_t item) const {
  const auto [begin, end] = words_of(item);
  return static_cast<float>(end - begin) * 0x1p-32f;
}

}  // namespace carousel::shading
