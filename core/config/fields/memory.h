#pragma once

#include <cstdint>
#include <optional>

#include "core/config/fields/dram.h"
#include "core/config/fields/engine_kind.h"
#include "core/config/fields/field.h"

namespace carousel {

struct MemoryConfig {
  std::int64_t l2_kib = 512, line_bytes = 64, ways = 16, shared_by = 8;
  std::int64_t l2_lines_per_cycle = 4, l2_latency_cycles = 160, dram_latency_cycles = 200, dram_bytes_per_cycle = 64;
  enum class Fetch { kPacket, kResource, kMulticast } fetch = Fetch::kResource;
  std::int64_t fetch_ahead = 2, shape_buffer_kib = 32;
  enum class ShapeStay { kUntilReplaced, kWhileUsed } shape_stay = ShapeStay::kUntilReplaced;
  enum class StripEnd { kLength, kFlag } strip_end = StripEnd::kLength;
  std::int64_t strip_ahead = 0;
  std::int64_t l2_banks = 1, l2_mshrs = 0;
  std::optional<std::int64_t> l2_sector_bytes;  ///< absent: a whole line
  enum class Write { kThrough, kBack } l2_write = Write::kThrough;
  std::int64_t l2_ray_ways = 0, l2_answer_bytes_per_cycle = 0;
  enum class RayRecords { kResource, kMaster } ray_records = RayRecords::kResource;
  enum class ShadingData {
    kFree,
    kMemory
  } path_state = ShadingData::kFree,
    film = ShadingData::kFree, sky_map = ShadingData::kFree, surfaces = ShadingData::kFree;
  std::int64_t l1_kib = 0, l1_ways = 8, l1_lines_per_cycle = 1, l1_mshrs = 0, l1_latency_cycles = 20;
  struct Translation {
    std::int64_t page_bytes = 0, entries = 64;
  } translation;
  DramConfig dram;
};

template <>
inline constexpr auto kEnumNames<MemoryConfig::Fetch> = [] {
  using enum MemoryConfig::Fetch;
  return names<MemoryConfig::Fetch>({{kPacket, "packet"}, {kResource, "resource"}, {kMulticast, "multicast"}});
}();

template <>
inline constexpr auto kEnumNames<MemoryConfig::ShapeStay> = [] {
  using enum MemoryConfig::ShapeStay;
  return names<MemoryConfig::ShapeStay>({{kUntilReplaced, "until_replaced"}, {kWhileUsed, "while_used"}});
}();

template <>
inline constexpr auto kEnumNames<MemoryConfig::StripEnd> = [] {
  using enum MemoryConfig::StripEnd;
  return names<MemoryConfig::StripEnd>({{kLength, "length"}, {kFlag, "flag"}});
}();

template <>
inline constexpr auto kEnumNames<MemoryConfig::Write> = [] {
  using enum MemoryConfig::Write;
  return names<MemoryConfig::Write>({{kThrough, "through"}, {kBack, "back"}});
}();

template <>
inline constexpr auto kEnumNames<MemoryConfig::RayRecords> = [] {
  using enum MemoryConfig::RayRecords;
  return names<MemoryConfig::RayRecords>({{kResource, "resource"}, {kMaster, "master"}});
}();

template <>
inline constexpr auto kEnumNames<MemoryConfig::ShadingData> = [] {
  using enum MemoryConfig::ShadingData;
  return names<MemoryConfig::ShadingData>({{kFree, "free"}, {kMemory, "memory"}});
}();

namespace config {

template <class V>
void describe(V& v, MemoryConfig::Translation& c) {
  v.field("page_bytes", c.page_bytes, IntRange{0, 1 << 30}, "bytes",
          "The size of a page, a power of two from 4096. With 0 addresses are physical.");
  v.field("entries", c.entries, IntRange{1, 65536}, "entries",
          "The pages that the TLB of a shared cache holds. For another one its walker reads the levels of the page "
          "table from the memory, one after another.")
      .relax("memory_tlb", Better::kTwice, Relaxed{}, c.page_bytes > 0);
}

template <class V>
void describe(V& v, MemoryConfig& c) {
  v.field("l2_kib", c.l2_kib, IntRange{1, 1 << 20}, "KiB", "The size of a shared cache.")
      .relax("l2_size", Better::kTwice, Relaxed{.keeps_shapes = true});
  v.field("line_bytes", c.line_bytes, IntRange{16, 1024}, "bytes", "The size of a cache line.");
  v.field("ways", c.ways, IntRange{1, 64}, "ways", "The associativity of a shared cache.");
  v.field("shared_by", c.shared_by, IntRange{1, kMaxResources}, "resources",
          "The number of resources that share one cache.");
  v.field("l2_lines_per_cycle", c.l2_lines_per_cycle, IntRange{1, 64}, "lines/cycle",
          "The number of lines that a bank of a shared cache looks up in a cycle.")
      .relax("l2_port", Better::kTwice);
  v.field("l2_banks", c.l2_banks, IntRange{1, 64}, "banks",
          "The number of banks of a shared cache, which hold its lines in turn.");
  v.field("l2_mshrs", c.l2_mshrs, IntRange{0, 65536}, "lines",
          "The number of lines, or sectors, that a bank can have on their way from memory. With 0 there is no bound.")
      .relax("l2_mshrs", Better::kTwice);
  v.field_or_auto("l2_sector_bytes", c.l2_sector_bytes, IntRange{16, 1024}, "bytes",
                  "The part of a line that is fetched by itself. With auto it is the whole line.");
  v.choice("l2_write", c.l2_write,
           "A line that is written goes on to memory at once, or when it is replaced in the shared cache.");
  v.field("l2_ray_ways", c.l2_ray_ways, IntRange{0, 63}, "ways",
          "The ways of a shared cache that hold data of rays and paths only; shapes take the others. With 0 all data "
          "takes all ways.");
  v.field("l2_answer_bytes_per_cycle", c.l2_answer_bytes_per_cycle, IntRange{0, 4096}, "bytes/cycle",
          "The width of the wires on which a shared cache answers, one request at a time. With 0 there is no limit.");
  v.field("l1_kib", c.l1_kib, IntRange{0, 1 << 20}, "KiB",
          "The size of a resource's own cache, before the shared one. With 0 there is none.")
      .relax("l1_size", Better::kTwice, Relaxed{.keeps_shapes = true});
  v.field("l1_ways", c.l1_ways, IntRange{1, 64}, "ways", "The associativity of a resource's own cache.");
  v.field("l1_lines_per_cycle", c.l1_lines_per_cycle, IntRange{1, 64}, "lines/cycle",
          "The number of lines that a resource's own cache looks up in a cycle.")
      .relax("l1_port", Better::kTwice);
  v.field(
       "l1_mshrs", c.l1_mshrs, IntRange{0, 65536}, "lines",
       "The number of lines, or sectors, that a resource's own cache can have on their way. With 0 there is no bound.")
      .relax("l1_mshrs", Better::kTwice);
  v.field("l1_latency_cycles", c.l1_latency_cycles, kCycles, "cycles", "The time of a hit in a resource's own cache.");
  v.field("l2_latency_cycles", c.l2_latency_cycles, kCycles, "cycles", "The time of a hit in the shared cache.")
      .relax("memory_latency", Better::kHalf);
  v.field("dram_latency_cycles", c.dram_latency_cycles, kCycles, "cycles",
          "The time of a miss; of DRAM with banks the way there and back.")
      .relax("memory_latency", Better::kHalf);
  v.field("dram_bytes_per_cycle", c.dram_bytes_per_cycle, IntRange{1, 65536}, "bytes/cycle",
          "The bandwidth of the pipe.")
      .relax("memory_bandwidth", Better::kTwice);
  v.choice("fetch", c.fetch,
           "Shape data is fetched by the issuer of a packet, which brings it along, by each resource, or once for all.")
      .only(EngineKind::kCycle, "simulated memory", MemoryConfig::Fetch::kMulticast);
  v.choice("ray_records", c.ray_records,
           "The record of a ray is in its resource only, or a master copy is in memory, from which the resource reads "
           "it and to which it comes back.")
      .only(EngineKind::kCycle, "simulated memory", MemoryConfig::RayRecords::kMaster);
  v.choice("path_state", c.path_state,
           "The state of a path is where shading needs it, or it is written to memory with each of its rays and read "
           "when that is shaded.")
      .only(EngineKind::kCycle, "simulated memory", MemoryConfig::ShadingData::kMemory);
  v.choice("film", c.film, "Light is added to the picture for nothing, or a pixel is read from memory and written.")
      .only(EngineKind::kCycle, "simulated memory", MemoryConfig::ShadingData::kMemory);
  v.choice("sky_map", c.sky_map,
           "The texels of scene.sky.file that shading reads, and the tables by which it draws light from the map, are "
           "where shading needs them, or they are read from memory for each ray before that is shaded.")
      .only(EngineKind::kCycle, "simulated memory", MemoryConfig::ShadingData::kMemory);
  v.choice("surfaces", c.surfaces,
           "The materials, vertices and texels that shading reads without shading.program are where shading needs "
           "them, or they are read from memory for each ray before that is shaded.")
      .only(EngineKind::kCycle, "simulated memory", MemoryConfig::ShadingData::kMemory);
  v.field("fetch_ahead", c.fetch_ahead, IntRange{0, 64}, "packets",
          "The number of packets whose shapes are fetched in advance.")
      .relax("fetch_ahead", Better::kTwiceOrOne);
  v.choice("strip_end", c.strip_end,
           "The request for a strip names its length, or only its address and stride, and its last shape has an end "
           "flag.")
      .only(EngineKind::kCycle, "simulated memory", MemoryConfig::StripEnd::kFlag);
  v.field("strip_ahead", c.strip_ahead, IntRange{0, 64}, "lines",
          "With strip_end: flag, the lines of a strip that are looked up ahead of the next one whose flags are read.");
  v.field("shape_buffer_kib", c.shape_buffer_kib, IntRange{1, 1 << 20}, "KiB",
          "The shape data that a resource holds, in places of 64 bytes.")
      .relax("shape_buffer", Better::kTwice, Relaxed{.keeps_shapes = true});
  v.choice(
      "shape_stay", c.shape_stay,
      "Shapes keep their places until others need them, or only while a test, or a packet whose shapes are fetched "
      "in advance, uses them.");
  v.section("translation", c.translation,
            "Pages of what the shared caches ask the memory for: shapes, and all other data.");
  v.section("dram", c.dram, "The memory behind the shared caches.");
}

}  // namespace config
}  // namespace carousel
