// What looking at a map of the sky, and drawing light from it, reads of memory.
#include <algorithm>
#include <cmath>

#include "shading/lights/sky_light.h"

namespace carousel::shading {

namespace {

/// Thresholds are read in blocks: the last steps of a search stay in one.
constexpr std::uint64_t kBlock = 64;

void append_block(std::uint64_t at, std::vector<SkyRead>& out) {
  const SkyRead read{at / kBlock * kBlock, static_cast<std::uint32_t>(kBlock)};
  if (out.empty() || out.back() != read) out.push_back(read);
}

}  // namespace

void SkyLight::append_texels(const Place& at, std::vector<SkyRead>& out) const {
  const std::int64_t width = map_.width, last = std::int64_t{map_.height} - 1;
  const auto left = static_cast<std::int64_t>(std::floor(at.x - 0.5));
  const auto top = static_cast<std::int64_t>(std::floor(at.y - 0.5));
  const std::int64_t upper = std::clamp<std::int64_t>(top, 0, last), lower = std::clamp<std::int64_t>(top + 1, 0, last);
  const std::int64_t x0 = (left + width) % width, x1 = (left + 1 + width) % width;
  const auto append = [&](std::int64_t y) {
    const auto offset = [&](std::int64_t x) { return static_cast<std::uint64_t>(y * width + x) * kTexelBytes; };
    if (x1 == x0 + 1) return out.push_back({offset(x0), 2 * kTexelBytes});
    out.push_back({offset(x0), kTexelBytes});
    if (x1 != x0) out.push_back({offset(x1), kTexelBytes});
  };
  append(upper);
  if (lower != upper) append(lower);
}

void SkyLight::append_reads(const Vec3& direction, std::vector<SkyRead>& out) const {
  const Place at = place_of(direction);
  append_texels(at, out);
  const auto [row, column] = texel_of(at);
  append_block(rows_at() + std::uint64_t{row} * kThresholdBytes, out);
  append_block(columns_at(row) + std::uint64_t{column} * kThresholdBytes, out);
}

void SkyLight::append_reads(const Vec2& u, std::vector<SkyRead>& out) const {
  const std::uint32_t row = rows_.choose(
      word_of(u.y), [&](std::uint32_t i) { append_block(rows_at() + std::uint64_t{i} * kThresholdBytes, out); });
  columns_[row].choose(
      word_of(u.x), [&](std::uint32_t i) { append_block(columns_at(row) + std::uint64_t{i} * kThresholdBytes, out); });
  append_texels(place_of(sample(u).direction), out);
}

}  // namespace carousel::shading
