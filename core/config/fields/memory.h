#pragma once

#include <cstdint>

#include "core/config/fields/field.h"

namespace carousel {

struct MemoryConfig {
  std::int64_t l2_kib = 512, line_bytes = 64, ways = 16, shared_by = 8;
  std::int64_t l2_lines_per_cycle = 4, l2_latency_cycles = 160, dram_latency_cycles = 200, dram_bytes_per_cycle = 64;
  enum class Fetch { kPacket, kResource, kMulticast } fetch = Fetch::kResource;
  std::int64_t fetch_ahead = 2, shape_buffer_kib = 32;
};

template <>
inline constexpr auto kEnumNames<MemoryConfig::Fetch> = [] {
  using enum MemoryConfig::Fetch;
  return names<MemoryConfig::Fetch>({{kPacket, "packet"}, {kResource, "resource"}, {kMulticast, "multicast"}});
}();

namespace config {

template <class V>
void describe(V& v, MemoryConfig& c) {
  v.field("l2_kib", c.l2_kib, IntRange{1, 1 << 20}, "KiB", "The size of a shared cache.");
  v.field("line_bytes", c.line_bytes, IntRange{16, 1024}, "bytes", "The size of a cache line.");
  v.field("ways", c.ways, IntRange{1, 64}, "ways", "The associativity of a shared cache.");
  v.field("shared_by", c.shared_by, IntRange{1, kMaxResources}, "resources",
          "The number of resources that share one cache.");
  v.field("l2_lines_per_cycle", c.l2_lines_per_cycle, IntRange{1, 64}, "lines/cycle",
          "The number of lines that a shared cache looks up in a cycle.");
  v.field("l2_latency_cycles", c.l2_latency_cycles, kCycles, "cycles", "The time of a hit in the shared cache.");
  v.field("dram_latency_cycles", c.dram_latency_cycles, kCycles, "cycles", "The time of a miss.");
  v.field("dram_bytes_per_cycle", c.dram_bytes_per_cycle, IntRange{1, 65536}, "bytes/cycle",
          "The bandwidth of the memory.");
  v.choice(
      "fetch", c.fetch,
      "Shape data is fetched by the issuer of a packet, which brings it along, by each resource, or once for all.");
  v.field("fetch_ahead", c.fetch_ahead, IntRange{0, 64}, "packets",
          "The number of packets whose shapes are fetched in advance.");
  v.field("shape_buffer_kib", c.shape_buffer_kib, IntRange{1, 1 << 20}, "KiB",
          "The shape data that a resource holds, in places of 64 bytes.");
}

}  // namespace config
}  // namespace carousel
