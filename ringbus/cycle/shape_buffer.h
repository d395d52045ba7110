#pragma once

#include <bit>

#include "core/config.h"
#include "ringbus/cycle/line_cache.h"
#include "ringbus/cycle/shape_memory.h"

namespace carousel::ringbus::cycle {

/// The strips a resource has at hand: room for memory.shape_buffer_kib in places of a node's size.
class ShapeBuffer {
 public:
  explicit ShapeBuffer(const MemoryConfig& config)
      : cache_(static_cast<std::uint64_t>(config.shape_buffer_kib) * 1024, sizeof(accel::Node), 16) {}

  bool has(const ShapeSpan& strip) { return cache_.touch(tag(strip)); }
  void keep(const ShapeSpan& strip) { cache_.insert(tag(strip)); }

 private:
  // Strips begin at multiples of 32; an odd factor spreads them over the sets and keeps them apart.
  static std::uint64_t tag(const ShapeSpan& strip) { return std::rotr(strip.address * 0x9e3779b97f4a7c15ull, 40); }
  LineCache cache_;
};

}  // namespace carousel::ringbus::cycle
