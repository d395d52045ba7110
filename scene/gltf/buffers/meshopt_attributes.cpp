// KHR_meshopt_compression (github.com/KhronosGroup/glTF): appendix A, mode 0, version 1; appendix B, filter 4.
#include "scene/gltf/buffers/meshopt_attributes.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

namespace carousel::scene {

namespace {

constexpr unsigned char kVersion1 = 0xa1;
constexpr std::size_t kGroup = 16;  // elements
constexpr std::size_t kShortestTail = 24;

/// The bytes of a stream from its header to its tail.
class Input {
 public:
  explicit Input(std::span<const unsigned char> rest) : rest_(rest) {}

  std::size_t left() const { return rest_.size(); }
  /// The next bytes; fewer than asked for at the end.
  std::span<const unsigned char> take(std::size_t bytes) {
    const auto out = rest_.first(std::min(bytes, rest_.size()));
    rest_ = rest_.subspan(out.size());
    return out;
  }

 private:
  std::span<const unsigned char> rest_;
};

/// One group of deltas of `bits` bits each: 0 (all are zero), 1, 2, 4 or 8.
bool read_group(Input& in, unsigned bits, std::span<unsigned char, kGroup> out) {
  if (bits == 0) {
    std::ranges::fill(out, static_cast<unsigned char>(0));
    return true;
  }
  const auto packed = in.take(kGroup * bits / 8);
  if (packed.size() != kGroup * bits / 8) return false;
  const unsigned sentinel = (1u << bits) - 1, per_byte = 8 / bits;
  for (unsigned i = 0; i < kGroup; ++i) {
    const unsigned place = i % per_byte;
    const unsigned shift = bits == 1 ? place : 8 - bits * (place + 1);  // one bit: the lowest first; else the highest
    const unsigned value = (packed[i / per_byte] >> shift) & sentinel;
    out[i] = static_cast<unsigned char>(value);
    if (bits == 8 || value != sentinel) continue;
    const auto whole = in.take(1);
    if (whole.empty()) return false;
    out[i] = whole[0];
  }
  return true;
}

/// The deltas of one byte of all elements of a block.
bool read_deltas(Input& in, unsigned control, std::span<unsigned char> out) {
  constexpr std::array<std::array<unsigned, 4>, 2> kBits{{{0, 1, 2, 4}, {1, 2, 4, 8}}};
  if (control == 2) {
    std::ranges::fill(out, static_cast<unsigned char>(0));
    return true;
  }
  if (control == 3) {
    const auto literal = in.take(out.size());
    std::ranges::copy(literal, out.begin());
    return literal.size() == out.size();
  }
  const std::size_t groups = (out.size() + kGroup - 1) / kGroup;
  const auto header = in.take((groups + 3) / 4);
  if (header.size() != (groups + 3) / 4) return false;
  for (std::size_t g = 0; g < groups; ++g) {
    std::array<unsigned char, kGroup> group{};
    if (!read_group(in, kBits[control][(header[g / 4] >> (2 * (g % 4))) & 3u], group)) return false;
    const std::size_t first = g * kGroup;
    std::copy_n(group.begin(), std::min(kGroup, out.size() - first), out.begin() + std::ptrdiff_t(first));
  }
  return true;
}

/// Zigzag: the lowest bit is the sign.
template <class T>
T unfolded(T v) {
  return static_cast<T>((v & 1u) != 0 ? ~(v >> 1) : v >> 1);
}

/// The four bytes of a channel that follow `last`, of their deltas.
std::uint32_t next_value(unsigned mode, unsigned rotation, std::uint32_t delta, std::uint32_t last) {
  if (mode == 2) return std::rotr(delta, static_cast<int>(rotation)) ^ last;
  const unsigned step = mode == 0 ? 8 : 16;
  std::uint32_t out = 0;
  for (unsigned at = 0; at < 32; at += step) {
    const std::uint32_t d = delta >> at, l = last >> at;
    const std::uint32_t sum =
        mode == 0 ? std::uint8_t(unfolded(std::uint8_t(d)) + l) : std::uint16_t(unfolded(std::uint16_t(d)) + l);
    out |= sum << at;
  }
  return out;
}

/// Little-endian, as glTF is.
std::uint32_t load(const unsigned char* from) {
  std::uint32_t value;
  std::memcpy(&value, from, sizeof value);
  return value;
}

}  // namespace

bool is_attributes_v1(std::span<const unsigned char> packed) {
  return !packed.empty() && packed[0] == kVersion1;
}

bool decode_attributes_v1(std::span<unsigned char> out, std::size_t stride, std::span<const unsigned char> packed) {
  const std::size_t channels = stride / 4, tail = std::max(stride + channels, kShortestTail);
  if (!is_attributes_v1(packed) || packed.size() < 1 + tail) return false;
  const auto modes = packed.last(channels);
  for (const unsigned char mode : modes)
    if ((mode & 15) > 2 || ((mode & 15) < 2 && mode >> 4 != 0)) return false;
  std::vector<std::uint32_t> last(channels);
  const auto first = packed.last(stride + channels);
  for (std::size_t c = 0; c < channels; ++c) last[c] = load(&first[4 * c]);

  Input in(packed.subspan(1, packed.size() - 1 - tail));
  const std::size_t most = std::min<std::size_t>((8192 / stride) & ~std::size_t{15}, 256);
  std::array<std::array<unsigned char, 256>, 4> deltas;
  for (std::size_t at = 0, count = out.size() / stride; at < count; at += most) {
    const std::size_t elements = std::min(most, count - at);
    const auto control = in.take(channels);
    if (control.size() != channels) return false;
    for (std::size_t c = 0; c < channels; ++c) {
      for (std::size_t b = 0; b < 4; ++b)
        if (!read_deltas(in, (control[c] >> (2 * b)) & 3u, std::span(deltas[b]).first(elements))) return false;
      for (std::size_t i = 0; i < elements; ++i) {
        std::uint32_t delta = 0;
        for (std::size_t b = 0; b < 4; ++b) delta |= std::uint32_t{deltas[b][i]} << (8 * b);
        last[c] = next_value(modes[c] & 15u, modes[c] >> 4, delta, last[c]);
        std::memcpy(&out[(at + i) * stride + 4 * c], &last[c], 4);
      }
    }
  }
  return in.left() == 0;
}

namespace {

template <class Unsigned, class Signed>
void decode_colors(std::span<unsigned char> data) {
  for (std::size_t at = 0; at + 4 * sizeof(Unsigned) <= data.size(); at += 4 * sizeof(Unsigned)) {
    std::array<Unsigned, 4> v;
    std::memcpy(v.data(), &data[at], sizeof v);
    const int y = v[0], co = static_cast<Signed>(v[1]), cg = static_cast<Signed>(v[2]);
    const unsigned top = (1u << std::bit_width(unsigned{v[3]})) - 1;  // the highest bit of alpha marks K
    const unsigned alpha = v[3] & (top >> 1);
    const int rgba[4] = {y + co - cg, y + cg, y - co - cg, static_cast<int>(alpha << 1 | (alpha & 1))};
    const float scale = top == 0 ? 0 : float{std::numeric_limits<Unsigned>::max()} / static_cast<float>(top);
    for (std::size_t c = 0; c < 4; ++c) {
      const float value = std::round(static_cast<float>(rgba[c]) * scale);
      v[c] = static_cast<Unsigned>(std::clamp(value, 0.0f, float{std::numeric_limits<Unsigned>::max()}));
    }
    std::memcpy(&data[at], v.data(), sizeof v);
  }
}

}  // namespace

void decode_filter_color(std::span<unsigned char> data, std::size_t stride) {
  if (stride == 4)
    decode_colors<std::uint8_t, std::int8_t>(data);
  else
    decode_colors<std::uint16_t, std::int16_t>(data);
}

}  // namespace carousel::scene
