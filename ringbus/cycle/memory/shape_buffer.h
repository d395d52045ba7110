#pragma once

#include <bit>

#include "core/config/config.h"
#include "ringbus/cycle/memory/line_cache.h"
#include "ringbus/cycle/memory/shape_memory.h"

namespace carousel::ringbus::cycle {

/// The strips that a resource has at hand: memory.shape_buffer_kib of them, in places of a node's size.
class ShapeBuffer {
 public:
  explicit ShapeBuffer(const MemoryConfig& config)
      : cache_(static_cast<std::uint64_t>(config.shape_buffer_kib) * 1024, sizeof(accel::Node), 16) {}

  /// Tells whether all of a strip is here.
  bool has(const ShapeSpan& strip) {
    bool all = true;
    for (std::uint32_t at = 0; at < strip.bytes; at += kPlace) all &= cache_.touch(tag(strip.address + at));
    return all;
  }
  void keep(const ShapeSpan& strip) {
    for (std::uint32_t at = 0; at < strip.bytes; at += kPlace) cache_.insert(tag(strip.address + at));
  }

 private:
  static constexpr std::uint32_t kPlace = sizeof(accel::Node);
  // An odd factor spreads them over the sets and keeps them apart.
  static std::uint64_t tag(std::uint64_t address) { return std::rotr(address * 0x9e3779b97f4a7c15ull, 40); }
  LineCache cache_;
};

}  // namespace carousel::ringbus::cycle
