#pragma once

#include <cstdint>

#include "core/config/fields/memory.h"
#include "ringbus/time/channel_list.h"

namespace carousel::ringbus::cycle {

/// The bytes that come from memory at a time: a line, or with `memory.l2_sector_bytes` a part of it. Messages count in
/// these, and call each a line.
inline std::uint64_t fetched_bytes(const MemoryConfig& config) {
  return static_cast<std::uint64_t>(config.l2_sector_bytes.value_or(config.line_bytes));
}

/// A resource asks its cache for lines; `tag` comes back with the answer. Or it writes lines, which has no answer.
struct FetchRequest {
  std::uint64_t first_line = 0;
  std::uint32_t lines = 0;
  std::uint32_t tag = 0;
  std::uint32_t written = 0;  ///< bytes that it writes; 0 when it asks
  std::uint32_t skipped = 0;  ///< bytes of the first line before those that it writes
  std::uint32_t wanted = 0;   ///< with `others`: the bytes that it asks for, behind the skipped ones
  bool ends_by_flag = false;  ///< it names no number of lines: the cache finds the end of the strip
  bool ahead = false;         ///< nobody waits for the lines: the cache only fetches those that it has not
  std::uint64_t others = 0;   ///< clients of the cache that get the same bytes without asking, a bit each

  /// Address 8, number of lines 4 or a strip's stride 2, tag 4, a mask of 8 where there are others, and what is
  /// written.
  std::uint64_t bytes() const { return (ends_by_flag ? 14 : 16) + std::uint64_t{written} + (others != 0 ? 8 : 0); }
};
/// A shape buffer has asked its cache for lines: for parts that hear of such requests.
struct ShapeHint {
  std::uint64_t first_line = 0;
  std::uint64_t bytes() const { return 8; }
};

/// Set in the line number of a request to memory that writes the line, which has no answer.
inline constexpr std::uint64_t kWriteLine = std::uint64_t{1} << 63;
/// Set besides when all of the line is written, in a request of a resource's own cache to the L2.
inline constexpr std::uint64_t kWholeLine = std::uint64_t{1} << 62;
/// Shapes that come to a resource because another has asked for them (`memory.fetch: multicast`).
struct PushedShapes {
  std::uint64_t address = 0;
  std::uint32_t size = 0;
  std::uint64_t bytes() const { return size; }
};
/// All lines of the request are there.
struct FetchAnswer {
  std::uint32_t tag = 0;
  std::uint32_t size = 0;  ///< bytes of these lines; the tag goes with them
  std::uint64_t bytes() const { return size; }
};

/// Bytes of a request for a line, or of the address of one that is written.
inline constexpr std::uint64_t kAddressBytes = 8;

/// Bytes a cycle of the ports of an L2 and of a resource's own cache.
inline std::uint64_t l2_port_bytes(const MemoryConfig& config) {
  return fetched_bytes(config) * static_cast<std::uint64_t>(config.l2_lines_per_cycle * config.l2_banks);
}
inline std::uint64_t l1_port_bytes(const MemoryConfig& config) {
  return fetched_bytes(config) * static_cast<std::uint64_t>(config.l1_lines_per_cycle);
}

/// Between the resources and their caches.
struct FetchKinds {
  MessageKind requests, data;
  /// `width` of the wires of requests in bytes a cycle.
  FetchKinds(ChannelList& list, const MemoryConfig& config, std::uint64_t width)
      : requests(list.carry({"shape requests", "resources", config.l1_kib > 0 ? "L1" : "L2", "request wires", width})),
        data(config.l1_kib > 0 ? list.carry({"shape data", "L1", "resources", "L1's port", l1_port_bytes(config)})
                               : list.carry({"shape data", "L2", "resources", "L2's port", l2_port_bytes(config)})) {}
};

/// Between the L2s and memory. Entries that do not fit collection storage, and data of rays and paths, go to an L2 with
/// their requests, and on to memory in whole lines: `written`, whose addresses are among the requests.
struct MemoryKinds {
  MessageKind requests, lines, written;
  MemoryKinds(ChannelList& list, const MemoryConfig& config)
      : requests(list.carry({"line requests", "L2", "DRAM", "address wires",
                             kAddressBytes * static_cast<std::uint64_t>(config.l2_lines_per_cycle * config.l2_banks)},
                            kAddressBytes)),
        lines(list.carry({"lines", "DRAM", "L2", "DRAM's data wires"}, fetched_bytes(config))),
        written(list.carry({"written lines", "L2", "DRAM", "DRAM's data wires"})) {}
};

/// Between ray control and shading and the L2s, where data of rays and paths are in memory.
struct RayDataKinds {
  MessageKind requests, data;
  RayDataKinds(ChannelList& list, const MemoryConfig& config, std::uint64_t width)
      : requests(list.carry({"requests of ray data", "shading", "L2", "request wires", width})),
        data(list.carry({"ray data", "L2", "shading", "L2's port", l2_port_bytes(config)})) {}
};

/// Between the resources' own caches and the L2s.
struct OwnCacheKinds {
  MessageKind requests, lines;
  OwnCacheKinds(ChannelList& list, const MemoryConfig& config)
      : requests(list.carry({"line requests of L1", "L1", "L2", "address wires",
                             kAddressBytes * static_cast<std::uint64_t>(config.l1_lines_per_cycle)},
                            kAddressBytes)),
        lines(list.carry({"lines for L1", "L2", "L1", "L2's port", l2_port_bytes(config)}, fetched_bytes(config))) {}
};

/// From the L2s to resources that have not asked (`memory.fetch: multicast`).
inline MessageKind pushed_kind(ChannelList& list, const MemoryConfig& config) {
  return list.carry({"multicast shapes", "L2", "resources", "wires of answers",
                     static_cast<std::uint64_t>(config.l2_answer_bytes_per_cycle)});
}

}  // namespace carousel::ringbus::cycle
