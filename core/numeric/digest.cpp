#include "core/numeric/digest.h"

#include <cstring>

#include <fmt/format.h>

#include "core/numeric/bytes_digest.h"

namespace carousel {

namespace {

// The finaliser of SplitMix64 (Steele, Lea, Flood 2014, "Fast splittable pseudorandom number generators").
std::uint64_t mix(std::uint64_t x) {
  x ^= x >> 30;
  x *= 0xbf58476d1ce4e5b9ull;
  x ^= x >> 27;
  x *= 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

struct Chain {
  std::uint64_t a = 0x9e3779b97f4a7c15ull, b = 0xd1b54a32d192ed03ull;
  void feed(std::uint64_t word) {
    a = mix(a + word);
    b = mix(b ^ (word * 0x9e3779b97f4a7c15ull + 0x632be59bd9b4e019ull)) + a;
  }
};

std::uint64_t pair(std::uint32_t high, std::uint32_t low) {
  return std::uint64_t{high} << 32 | low;
}

}  // namespace

HitsDigest hit_term(std::uint32_t pixel, std::uint32_t sample, const RayTag& tag, const Hit& hit) {
  Chain chain;
  chain.feed(pair(pixel, sample));
  chain.feed(pair(std::uint32_t{tag.bounce} << 16 | std::uint32_t(tag.kind) << 8 | tag.index, hit.valid() ? 1 : 0));
  if (tag.kind != RayKind::kShadow) {
    chain.feed(pair(hit.instance, hit.primitive));
    chain.feed(pair(std::bit_cast<std::uint32_t>(hit.t), std::bit_cast<std::uint32_t>(hit.u)));
    chain.feed(std::bit_cast<std::uint32_t>(hit.v));
  }
  return {chain.a, chain.b};
}

std::string HitsDigest::hex() const {
  return fmt::format("{:016x}{:016x}", hi, lo);
}

std::string bytes_digest(std::string_view bytes) {
  Chain chain;
  chain.feed(bytes.size());
  for (; bytes.size() >= 8; bytes.remove_prefix(8)) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes.data(), 8);
    chain.feed(word);
  }
  std::uint64_t rest = 0;
  for (const char byte : bytes) rest = rest << 8 | static_cast<unsigned char>(byte);
  chain.feed(rest);
  return fmt::format("{:016x}{:016x}", chain.b, chain.a);
}

std::string image_digest(std::span<const float> rgb) {
  Chain chain;
  chain.feed(rgb.size());
  for (const float value : rgb) chain.feed(std::bit_cast<std::uint32_t>(value));
  return fmt::format("{:016x}{:016x}", chain.b, chain.a);
}

}  // namespace carousel
