#include "shading/camera/film.h"

#include "core/numeric/fixed_point.h"

namespace carousel::shading {

Film::Film(std::uint32_t width, std::uint32_t height, std::uint32_t samples)
    : width_(width),
      height_(height),
      samples_(samples),
      sums_(std::make_unique<std::atomic<std::int64_t>[]>(3 * std::size_t{width} * height)) {}

void Film::append_sums(std::vector<std::uint64_t>& numbers) const {
  for (std::size_t i = 0; i < 3 * std::size_t{width_} * height_; ++i)
    numbers.push_back(static_cast<std::uint64_t>(sums_[i].load(std::memory_order_relaxed)));
}

void Film::set_sums(std::span<const std::uint64_t> numbers) {
  for (std::size_t i = 0; i < numbers.size(); ++i)
    sums_[i].store(static_cast<std::int64_t>(numbers[i]), std::memory_order_relaxed);
}

std::vector<float> Film::linear_rgb() const {
  std::vector<float> rgb(3 * std::size_t{width_} * height_);
  for (std::size_t i = 0; i < rgb.size(); ++i) {
    rgb[i] = mean_of_fixed_point(sums_[i].load(std::memory_order_relaxed), samples_);
  }
  return rgb;
}

}  // namespace carousel::shading
