#pragma once

#include "report/sections/visitor.h"

namespace carousel::report {

/// A quantity of one part over time.
struct SeriesRow {
  std::string part, quantity, unit, kind;
  std::vector<double> values{};
};

template <class V>
void describe(V& v, const SeriesRow& r) {
  v.field("part", r.part, "",
          "machine, resource N, link N as in links, or pool N as in shading.pools; rows of the machine come first");
  v.field("quantity", r.quantity, "", "what is counted, or how full or busy the part is");
  v.field("unit", r.unit, "", "rays, packets, bytes, entries, workers, visits, J or share");
  v.field("kind", r.kind, "", "sum: the amount within a sample; mean: the mean over the time of a sample");
  v.field("values", r.values, "", "a number for each sample");
}

/// Rows of equally many samples. A row that is zero throughout is left out.
struct TimeSeries {
  std::string unit;
  double interval = 0;
  std::uint64_t samples = 0;
  std::vector<SeriesRow> rows{};
};

template <class V>
void describe(V& v, const TimeSeries& r) {
  v.field("unit", r.unit, "", "unit of interval: cycles or seconds");
  v.field(
      "interval", r.interval, "cycles|seconds",
      "length of a sample; sample i covers the time from i to i + 1 intervals, the last one also time after the end, "
      "in which nothing happens");
  v.field("samples", r.samples, "samples", "length of each row; see report.samples in the configuration");
  v.section("rows", r.rows, "each quantity of each part that is not zero throughout");
}

}  // namespace carousel::report
