#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/types/vec.h"

namespace carousel::shading {

/// Sums of radiance per pixel in fixed point (core/numeric/fixed_point.h), so that they do not depend on order.
class Film {
 public:
  /// All at least 1.
  Film(std::uint32_t width, std::uint32_t height, std::uint32_t samples);

  /// Adds one path's radiance, in fixed point, each channel within +-kFixedPointMax. Any thread.
  void add(std::uint32_t pixel, std::int64_t r, std::int64_t g, std::int64_t b) {
    std::atomic<std::int64_t>* p = &sums_[3 * std::size_t{pixel}];
    // Relaxed: the sums are read when the frame is done, and joining the workers orders these additions before the
    // reads.
    p[0].fetch_add(r, std::memory_order_relaxed);
    p[1].fetch_add(g, std::memory_order_relaxed);
    p[2].fetch_add(b, std::memory_order_relaxed);
  }

  /// Mean over the samples, row-major from the top left, 3 floats a pixel. While a frame is being rendered, the sum of
  /// the paths committed so far.
  std::vector<float> linear_rgb() const;

  /// The sums as numbers modulo 2^64, for films of one picture to be added up: those of this film behind `numbers`.
  void append_sums(std::vector<std::uint64_t>& numbers) const;
  /// The sums of all these films, as append_sums() has put them.
  void set_sums(std::span<const std::uint64_t> numbers);

  std::uint32_t width() const { return width_; }
  std::uint32_t height() const { return height_; }

 private:
  std::uint32_t width_, height_, samples_;
  std::unique_ptr<std::atomic<std::int64_t>[]> sums_;
};

}  // namespace carousel::shading
