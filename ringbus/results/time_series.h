#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace carousel::ringbus {

/// A quantity of one part over time.
struct SeriesRow {
  enum class Kind : std::uint8_t { kSum, kMean };  ///< the amount within a sample, or the mean over its time

  std::string part;
  std::string quantity;
  std::string_view unit;  ///< a literal
  Kind kind = Kind::kSum;
  std::vector<double> values{};
  friend bool operator==(const SeriesRow&, const SeriesRow&) = default;
};

/// Rows of equally many samples; none of them is zero throughout.
struct TimeSeries {
  /// The most numbers in all rows.
  static constexpr std::size_t kMostNumbers = std::size_t{1} << 18;

  std::string_view unit;  ///< unit of `interval`: a literal
  double interval = 0;    ///< length of a sample
  std::size_t samples = 0;
  std::vector<SeriesRow> rows{};
  friend bool operator==(const TimeSeries&, const TimeSeries&) = default;

  void add(SeriesRow&& row) {
    if (std::any_of(row.values.begin(), row.values.end(), [](double value) { return value != 0; }))
      rows.push_back(std::move(row));
  }
};

/// How many samples a row may have if `wanted` are asked for and there are so many rows; at least 16, unless none is
/// wanted.
inline std::size_t most_samples(std::size_t wanted, std::size_t rows) {
  if (wanted == 0) return 0;
  return std::clamp<std::size_t>(TimeSeries::kMostNumbers / std::max<std::size_t>(1, rows), 16, wanted);
}

}  // namespace carousel::ringbus
