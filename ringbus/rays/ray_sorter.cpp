#include "ringbus/rays/ray_sorter.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace carousel::ringbus {

namespace {

constexpr int kDigitBits = 12, kDigits = 2;
static_assert(3 * RaySorter::kCellBits + 3 == kDigitBits * kDigits, "cell and octant");
constexpr std::size_t kFewRays = 1024;  // fewer have no digits worth counting
constexpr std::size_t kAhead = 16;      // rays fetched before they are copied

/// The bits of a number below 1024 in every third place.
constexpr std::uint32_t every_third(std::uint32_t x) {
  x = (x | x << 16) & 0x030000ffu;
  x = (x | x << 8) & 0x0300f00fu;
  x = (x | x << 4) & 0x030c30c3u;
  return (x | x << 2) & 0x09249249u;
}

/// The cells of a batch: cubes, as many along its longest side as kCellBits number.
class Cells {
 public:
  explicit Cells(const RayBatch& rays) {
    Aabb bounds;
    for (const RayRequest& request : rays)
      if (finite(request.ray.origin)) bounds.extend(request.ray.origin);
    lo_ = bounds.lo;
    double longest = 0;
    for (int axis = 0; axis < 3; ++axis) longest = std::max(longest, double{bounds.hi[axis]} - double{lo_[axis]});
    if (longest > 0) scale_ = (1 << RaySorter::kCellBits) / longest;
  }

  /// Origins beyond all floats lie in some cell, too.
  std::uint32_t key(const Ray& ray) const {
    constexpr double kLast = (1 << RaySorter::kCellBits) - 1;
    std::uint32_t cell = 0, octant = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const double place = (double{ray.origin[axis]} - double{lo_[axis]}) * scale_;
      const double inside = place > 0 ? std::min(place, kLast) : 0;  // not a number: 0
      cell |= every_third(static_cast<std::uint32_t>(inside)) << axis;
      octant |= (std::bit_cast<std::uint32_t>(ray.direction[axis]) >> 31) << axis;
    }
    return cell << 3 | octant;
  }

 private:
  static bool finite(const Vec3& p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

  Vec3 lo_;
  double scale_ = 0;
};

}  // namespace

void RaySorter::order(const RayBatch& rays) {
  const Cells cells(rays);
  keys_.resize(rays.size());
  for (std::size_t i = 0; i < rays.size(); ++i) keys_[i] = std::uint64_t{cells.key(rays[i].ray)} << 32 | i;
  if (keys_.size() < kFewRays) return std::sort(keys_.begin(), keys_.end());
  other_.resize(keys_.size());
  for (int digit = 0; digit < kDigits; ++digit) {
    const auto digit_of = [&](std::uint64_t key) {
      return key >> (32 + kDigitBits * digit) & ((1u << kDigitBits) - 1);
    };
    std::array<std::uint32_t, 1u << kDigitBits> next{};
    for (const std::uint64_t key : keys_) ++next[digit_of(key)];
    std::uint32_t before = 0;
    for (std::uint32_t& n : next) {
      const std::uint32_t count = n;
      n = before;
      before += count;
    }
    for (const std::uint64_t key : keys_) other_[next[digit_of(key)]++] = key;
    keys_.swap(other_);
  }
}

void RaySorter::copy(const RayBatch& rays, std::size_t begin, std::size_t end, RayBatch& out) const {
  const auto ray = [&](std::size_t i) -> const RayRequest& { return rays[static_cast<std::uint32_t>(keys_[i])]; };
  for (std::size_t i = begin; i < end; ++i) {
    if (i + kAhead < end) __builtin_prefetch(&ray(i + kAhead));
    out.push_back(ray(i));
  }
}

}  // namespace carousel::ringbus
