#pragma once

#include <string>
#include <vector>

#include "bench/common/results.h"

namespace carousel::bench {

/// A Markdown table whose columns line up, so that it can be read on a terminal too.
class Table {
 public:
  explicit Table(std::vector<std::string> header) { rows_.push_back(std::move(header)); }
  /// A row of as many cells as the header has; the first column is text, the others are numbers.
  void add(std::vector<std::string> cells) { rows_.push_back(std::move(cells)); }
  std::string text() const;

 private:
  std::vector<std::vector<std::string>> rows_;
};

/// "2.41 (2.38 to 2.44)".
std::string spread_text(const Spread& spread);
/// Median rates, in million rays a second of wall or CPU time; 0 when that was not measured.
double wall_rate(const SetResult& set, const std::string& contestant, int threads);
double cpu_rate(const SetResult& set, const std::string& contestant, int threads);
/// "0.93", or empty if either is 0.
std::string ratio_text(double a, double b);

/// A table of all contestants on one set: million rays a second of wall time with the spread, and of CPU time. Ratios
/// to Embree (robust, single rays) and to the depth-first tracer are of CPU time, which other programs on the
/// machine disturb least; the ratio to fewer threads is of wall time, which includes waiting. A star marks a run that
/// was stopped before all rays were traced.
std::string set_table(const SetResult& set);
/// Counts per ray on one thread, for the contestants that report them. Empty if none does.
std::string work_table(const SetResult& set);
/// Build speeds, one row a scene and builder.
std::string build_table(const std::vector<SceneResult>& scenes);

}  // namespace carousel::bench
