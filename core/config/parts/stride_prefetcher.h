#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "core/config/fields/field.h"
#include "core/costs/costs.h"
#include "core/parts/part_list.h"
#include "core/statistics/counters.h"
#include "core/types/added_names.h"
#include "core/types/prefetcher_offer.h"

namespace carousel {

// ---- keys

struct StridePrefetcherKeys {
  std::int64_t lines = 0, streams = 4, reach = 64;
  PrefetchRule rule = PrefetchRule::kStrides;

  /// The prefetcher of a plugin that the rule names; null for a rule of the program.
  const PrefetcherOffer* own() const { return added_body<PrefetcherOffer>(rule); }
  PrefetcherSetup setup(std::uint32_t resources = 1) const { return {lines, streams, reach, resources}; }
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
  v.choice(
      "rule", c.rule,
      "The rule by which lines are chosen: along streams of equal strides, or as a plugin says, which may read the "
      "other keys of the section.");
}

}  // namespace config

// ---- counts

struct StridePrefetcherCounts {
  std::uint64_t hints = 0, streams = 0, followed = 0, lines = 0, met = 0;

  static constexpr auto counters() {
    using C = StridePrefetcherCounts;
    return std::array{
        Counter{"hints", &C::hints, "hints", "requests of shape buffers of which the prefetchers heard"},
        Counter{"streams", &C::streams, "streams",
                "streams that were begun in the place of older ones; a plugin's rule has none"},
        Counter{"followed", &C::followed, "hints",
                "hints that followed a stream by its stride; with a plugin's rule those on which it asked for lines"},
        Counter{"lines", &C::lines, "lines", "lines that were asked for ahead"},
        Counter{
            "met", &C::met, "lines",
            "those of them for which a shape buffer then asked, in the same stream or, with a plugin's rule, at all"},
    };
  }
  friend bool operator==(const StridePrefetcherCounts&, const StridePrefetcherCounts&) = default;
};

// ---- the part

/// A table of streams beside each L2 that fetches the lines of equal strides ahead of the shape buffers' requests.
struct StridePrefetcherPart {
  using Keys = StridePrefetcherKeys;
  using Counts = StridePrefetcherCounts;
  static constexpr const char* kSection = "prefetcher";
  static constexpr const char* kSwitch = "lines";
  static constexpr const char* kAbsent = "there is no prefetcher";
  static constexpr const char* kName = "prefetcher";
  static constexpr const char* kMeaning =
      "A prefetcher beside each shared cache, which follows equal strides or another rule.";
  static constexpr const char* kCountsMeaning = "work of the prefetchers beside the L2 caches, all together (cycle)";
  static constexpr const char* kAreaMeaning = "tables of streams of the prefetchers (KiB)";
  static constexpr const char* kEnergyMeaning =
      "accesses of 64 bits to the tables of streams: for each hint all streams are read and one is written, or as a "
      "plugin says of its rule";
  static bool is_built(const Keys& keys) { return keys.lines > 0; }
  /// Comparators are not counted.
  static PartArea area(const Keys& keys, const Costs& costs) {
    return {table_kib(keys), table_kib(keys) * costs.of(Cost::kSramArea)};
  }
  static PartEnergy energy(const Counts& counts, const Keys& keys, const Costs& costs) {
    const double accesses = keys.own() ? keys.own()->words_per_hint : kWords * static_cast<double>(keys.streams + 1);
    return {static_cast<double>(counts.hints) * accesses, costs.sram_access_pj(table_kib(keys))};
  }

 private:
  static constexpr double kWords = 2;  // of a stream: its last line; its stride, and the lines asked for ahead
  static double table_kib(const Keys& keys) {
    if (const PrefetcherOffer* own = keys.own())
      return std::max<double>(8, static_cast<double>(own->table_bytes(keys.setup()))) / 1024;
    return 8 * kWords * static_cast<double>(keys.streams) / 1024;
  }
};

}  // namespace carousel
