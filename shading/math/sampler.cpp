#include "shading/math/sampler.h"

#include <algorithm>
#include <cmath>

#include "shading/math/dimension.h"

namespace carousel::shading {

namespace {

constexpr float kBelowOne = 0x1.fffffep-1f;
constexpr std::uint32_t kStratifiedBounces = 1;

constexpr std::uint32_t index(Dimension dimension) {
  return static_cast<std::uint32_t>(dimension);
}
constexpr std::uint32_t block_of(Dimension dimension) {
  return index(dimension) / 4;
}

/// The i-th element of a permutation of [0, length), chosen by `pattern`: a hash that is a bijection on the
/// next power of two, walked until it lands inside. A. Kensler, "Correlated multi-jittered sampling", Pixar
/// Technical Memo 13-01, 2013, listing 3.
std::uint32_t permute(std::uint32_t i, std::uint32_t length, std::uint32_t pattern) {
  if (length <= 1) return 0;
  std::uint32_t mask = length - 1;
  mask |= mask >> 1;
  mask |= mask >> 2;
  mask |= mask >> 4;
  mask |= mask >> 8;
  mask |= mask >> 16;
  do {
    i ^= pattern;
    i *= 0xe170893du;
    i ^= pattern >> 16;
    i ^= (i & mask) >> 4;
    i ^= pattern >> 8;
    i *= 0x0929eb3fu;
    i ^= pattern >> 23;
    i ^= (i & mask) >> 1;
    i *= 1 | pattern >> 27;
    i *= 0x6935fa69u;
    i ^= (i & mask) >> 11;
    i *= 0x74dcb303u;
    i ^= (i & mask) >> 2;
    i *= 0x9e501cc3u;
    i ^= (i & mask) >> 2;
    i *= 0xc860a3dfu;
    i &= mask;
    i ^= i >> 5;
  } while (i >= length);
  return (i + pattern) % length;
}

}  // namespace

Sampler::Sampler(std::uint64_t seed, std::uint32_t samples) : seed_(seed), samples_(std::max(samples, 1u)) {
  columns_ = 1;
  while ((columns_ + 1) * (columns_ + 1) <= samples_) ++columns_;
  rows_ = (samples_ + columns_ - 1) / columns_;
}

CameraDraw Sampler::camera(std::uint32_t pixel, std::uint32_t sample) const {
  const RandomKey key{seed_, pixel, sample, 0};
  const PhiloxCounter words = random_block(key, block_of(Dimension::kPixelX));
  return {stratified(sample, pattern(key, index(Dimension::kPixelX)), words[0], words[1]),
          stratified(sample, pattern(key, index(Dimension::kLensX)), words[2], words[3])};
}

LightDraw Sampler::light(std::uint32_t pixel, std::uint32_t sample, std::uint32_t bounce) const {
  const RandomKey key{seed_, pixel, sample, bounce};
  const PhiloxCounter words = random_block(key, block_of(Dimension::kLightChoice));
  if (bounce >= kStratifiedBounces) {
    return {words[0], {unit_float(words[1]), unit_float(words[2])}, unit_float(words[3])};
  }
  return {stratified(sample, pattern(key, index(Dimension::kLightChoice)), words[0]),
          stratified(sample, pattern(key, index(Dimension::kLightU)), words[1], words[2]), unit_float(words[3])};
}

DirectionDraw Sampler::direction(std::uint32_t pixel, std::uint32_t sample, std::uint32_t bounce) const {
  const RandomKey key{seed_, pixel, sample, bounce};
  const PhiloxCounter words = random_block(key, block_of(Dimension::kLobe));
  if (bounce >= kStratifiedBounces) {
    return {unit_float(words[0]), {unit_float(words[1]), unit_float(words[2])}};
  }
  return {unit_float(stratified(sample, pattern(key, index(Dimension::kLobe)), words[0])),
          stratified(sample, pattern(key, index(Dimension::kDirectionU)), words[1], words[2])};
}

// Kensler 2013, listing 5: any number of samples on a columns x rows grid, one in each of `samples` rows.
Vec2 Sampler::stratified(std::uint32_t sample, std::uint32_t pattern, std::uint32_t jitter_x,
                         std::uint32_t jitter_y) const {
  const std::uint32_t s = permute(sample, samples_, pattern * 0x51633e2du);
  const std::uint32_t column = permute(s % columns_, columns_, pattern * 0x68bc21ebu);
  const std::uint32_t row = permute(s / columns_, rows_, pattern * 0x02e5be93u);
  const float x =
      (static_cast<float>(column) + (static_cast<float>(row) + unit_float(jitter_x)) / static_cast<float>(rows_)) /
      static_cast<float>(columns_);
  const float y = (static_cast<float>(s) + unit_float(jitter_y)) / static_cast<float>(samples_);
  return {std::min(x, kBelowOne), std::min(y, kBelowOne)};
}

std::uint32_t Sampler::stratified(std::uint32_t sample, std::uint32_t pattern, std::uint32_t jitter) const {
  const std::uint64_t stratum = permute(sample, samples_, pattern * 0x51633e2du);
  return static_cast<std::uint32_t>((stratum << 32 | jitter) / samples_);
}

// The value is the same for all samples of a pixel. It only picks a permutation, so a short mix
// (the finaliser of MurmurHash3, A. Appleby) is good enough instead of another ten rounds of Philox.
std::uint32_t Sampler::pattern(const RandomKey& key, std::uint32_t dimension) const {
  auto mix = [](std::uint32_t h) {
    h ^= h >> 16;
    h *= 0x85ebca6bu;
    h ^= h >> 13;
    h *= 0xc2b2ae35u;
    return h ^ h >> 16;
  };
  const std::uint32_t seed = static_cast<std::uint32_t>(seed_) ^ static_cast<std::uint32_t>(seed_ >> 32) * 0x9e3779b9u;
  return mix(mix(seed + key.pixel * 0x9e3779b9u) + (key.bounce << 8 | dimension) * 0x7feb352du);
}

}  // namespace carousel::shading
