#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "core/config/fields/field.h"
#include "core/costs/costs.h"
#include "core/parts/part_list.h"
#include "core/statistics/counters.h"

namespace carousel {

// ---- keys

struct StridePrefetcherKeys {
  std::int64_t lines = 0, streams = 4, reach = 64;
};

namespace config {

template <class V>
void describe(V& v, StridePrefetcherKeys& c) {
  v.field("lines", c.lines, IntRange{0, 16}, "lines",
          "The number of lines that are fetched ahead of a stream. With 0 there is no prefetcher.")
      .relax("prefetch", Better::kTwice, Relaxed{}, c.lines > 0);
  v.field("streams", c.streams, IntRange{1, 64}, "streams", "The number of streams that are followed at once.")
      .relax("prefetch_streams", Better::kTwice);
  v.field("reach", c.reach, IntRange{1, 4096}, "lines",
          "The greatest distance of a line from the last one of a stream of which it can be the next.");
}

}  // namespace config

// ---- counts

struct StridePrefetcherCounts {
  std::uint64_t hints = 0, streams = 0, followed = 0, lines = 0, met = 0;

  static constexpr auto counters() {
    using C = StridePrefetcherCounts;
    return std::array{
        Counter{"hints", &C::hints, "hints", "requests of shape buffers of which the prefetchers heard"},
        Counter{"streams", &C::streams, "streams", "streams that were begun in the place of older ones"},
        Counter{"followed", &C::followed, "hints", "hints that followed a stream by its stride"},
        Counter{"lines", &C::lines, "lines", "lines that were asked for ahead"},
        Counter{"met", &C::met, "lines", "those of them for which a shape buffer then asked, in the same stream"},
    };
  }
  friend bool operator==(const StridePrefetcherCounts&, const StridePrefetcherCounts&) = default;
};

// ---- the part

namespace ringbus::cycle {
struct PartSites;
template <class Counts>
struct AttachedPart;
/// Makes the prefetchers of a machine.
std::vector<AttachedPart<StridePrefetcherCounts>> attach(const StridePrefetcherKeys& keys, const PartSites& sites);
}  // namespace ringbus::cycle

/// A table of streams beside each L2 that fetches the lines of equal strides ahead of the shape buffers' requests.
struct StridePrefetcherPart {
  using Keys = StridePrefetcherKeys;
  using Counts = StridePrefetcherCounts;
  static constexpr const char* kSection = "prefetcher";
  static constexpr const char* kSwitch = "lines";
  static constexpr const char* kAbsent = "there is no prefetcher";
  static constexpr const char* kName = "prefetcher";
  static constexpr const char* kMeaning = "A prefetcher beside each shared cache, which follows equal strides.";
  static constexpr const char* kCountsMeaning = "work of the prefetchers beside the L2 caches, all together (cycle)";
  static constexpr const char* kAreaMeaning = "tables of streams of the prefetchers (KiB)";
  static constexpr const char* kEnergyMeaning =
      "accesses of 64 bits to the tables of streams: for each hint all streams are read and one is written";
  static bool is_built(const Keys& keys) { return keys.lines > 0; }
  /// Comparators are not counted.
  static PartArea area(const Keys& keys, const Costs& costs) {
    return {table_kib(keys), table_kib(keys) * costs.of(Cost::kSramArea)};
  }
  static PartEnergy energy(const Counts& counts, const Keys& keys, const Costs& costs) {
    const double accesses = kWords * static_cast<double>(keys.streams + 1);
    return {static_cast<double>(counts.hints) * accesses, costs.sram_access_pj(table_kib(keys))};
  }

 private:
  static constexpr double kWords = 2;  // of a stream: its last line; its stride, and the lines asked for ahead
  static double table_kib(const Keys& keys) { return 8 * kWords * static_cast<double>(keys.streams) / 1024; }
};

}  // namespace carousel
