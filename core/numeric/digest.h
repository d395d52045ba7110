#pragma once

#include <bit>
#include <cstdint>
#include <span>
#include <string>

#include "core/types/ray.h"

namespace carousel {

/// A sum modulo 2^128 of mixes, one a ray: equal sets of rays and hits give equal digests in any order.
/// Digests of disjoint sets are added.
struct HitsDigest {
  std::uint64_t lo = 0, hi = 0;

  void add(const HitsDigest& other) {
    lo += other.lo;
    hi += other.hi + (lo < other.lo ? 1 : 0);
  }
  friend bool operator==(const HitsDigest&, const HitsDigest&) = default;
  std::string hex() const;
};

/// The term of one ray. Shadow rays give only occluded (hit.valid()) or visible.
HitsDigest hit_term(std::uint32_t pixel, std::uint32_t sample, const RayTag& tag, const Hit& hit);

/// Hash of linear float RGB, row-major, as hex digits (little-endian bytes, whatever the host).
std::string image_digest(std::span<const float> rgb);

}  // namespace carousel
