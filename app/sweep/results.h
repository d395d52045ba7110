#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "app/sweep/plan/point.h"
#include "app/sweep/process/point_file.h"

namespace carousel::app {

/// The runs whose reports have a result.
enum class ResultOf { kEveryRun, kNativeRun, kCycleRun, kCostProfile };

/// A number or a name that is taken from the report of each point.
struct ResultColumn {
  std::string name;
  std::string path;  ///< in the report; empty: a result that is computed
  bool greater_is_better = false;
  ResultOf of = ResultOf::kEveryRun;
};

/// The column of the noise of a point's cycles, as a fraction of them (cycle_noise of the report).
inline constexpr const char* kNoiseColumn = "noise";

/// The results that every sweep shows, and those of `--result`, paths as in throughput.whole.rays_per_kilocycle.
std::vector<ResultColumn> result_columns(const std::vector<std::string>& paths);

/// The value of a column in a report; null if the report has none.
nlohmann::ordered_json result_of(const ResultColumn& column, const nlohmann::ordered_json& report);

/// A point in the tables of a sweep.
struct SweepRow {
  SweepPoint point;
  bool finished = false;
  std::optional<PointError> error;
  double seconds = 0;
  std::vector<nlohmann::ordered_json> results;  ///< a column each; empty if there are none
};

struct SweepRows {
  std::vector<std::string> keys;  ///< that vary
  std::vector<ResultColumn> columns;
  std::vector<SweepRow> rows;

  /// The index of a column. Throws ConfigError, which names the option that asks for it.
  std::size_t column(const std::string& name, const std::string& option) const;
  /// Throws a ConfigError that names the key to set if no point will have the result of the column: `base` is the
  /// configuration without the keys that vary.
  void require_result(std::size_t column, const Config& base, const std::string& option) const;
  /// The number in a column; absent for a point without it.
  std::optional<double> number(const SweepRow& row, std::size_t column) const;
  /// Leaves out the columns that no point has, but for those with the names `kept`, which somebody asked for.
  void drop_empty(const std::vector<std::string>& kept = {});
  std::size_t failed() const;
  std::size_t done() const;
};

/// Adds what the file of a point says to its row.
void fill_row(SweepRow& row, const std::vector<ResultColumn>& columns, const PointFile& file);

}  // namespace carousel::app
