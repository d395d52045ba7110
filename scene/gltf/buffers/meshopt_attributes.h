#pragma once

#include <cstddef>
#include <span>

namespace carousel::scene {

/// True for a stream of mode ATTRIBUTES in version 1, which meshoptimizer reads from 0.23 on only.
bool is_attributes_v1(std::span<const unsigned char> packed);

/// Decodes a stream of mode ATTRIBUTES in version 1. `out` holds a whole number of elements of `stride` bytes; `stride`
/// is a multiple of 4 from 4 to 256. Returns false for a stream that is broken, ends early or is too long; `out` is
/// then undefined.
[[nodiscard]] bool decode_attributes_v1(std::span<unsigned char> out, std::size_t stride,
                                        std::span<const unsigned char> packed);

/// Turns luma and chroma of K bits into red, green, blue and alpha, in place: the filter COLOR. `stride` is 4 or 8: the
/// bytes of four components.
void decode_filter_color(std::span<unsigned char> data, std::size_t stride);

}  // namespace carousel::scene
