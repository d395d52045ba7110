#include "app/sweep/noise.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <optional>
#include <string>

#include "core/numeric/noise_between.h"
#include "core/numeric/student.h"

namespace carousel::app {

namespace {

constexpr const char* kSeed = "image.seed";
constexpr const char* kOfCycles[] = {"cycles", "rays_per_kilocycle", "mrays_per_second", "mrays_per_second_per_mm2"};

/// The noise of a result by repeated points; absent without any.
std::optional<double> noise_of_repeats(const SweepRows& rows, std::size_t column) {
  if (std::find(rows.keys.begin(), rows.keys.end(), kSeed) == rows.keys.end()) return std::nullopt;
  std::map<std::vector<std::string>, std::vector<double>> groups;
  for (const SweepRow& row : rows.rows) {
    const auto value = rows.number(row, column);
    if (!value) continue;
    std::vector<std::string> point;
    for (const KeyValue& key : row.point.keys)
      if (key.first != kSeed) point.push_back(key.second);
    groups[point].push_back(*value);
  }
  double squares = 0, freedom = 0;
  for (const auto& [point, values] : groups) {
    const double mean = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
    if (mean == 0) continue;
    for (const double value : values) squares += std::pow(value / mean - 1, 2);
    freedom += static_cast<double>(values.size()) - 1;
  }
  if (freedom < 1) return std::nullopt;
  return student_95(freedom) * std::sqrt(2 * squares / freedom);
}

}  // namespace

std::vector<bool> ties_with_best(const SweepRows& rows, const Goal& goal) {
  std::vector<bool> out(rows.rows.size());
  if (goal.column >= rows.columns.size()) return out;
  const SweepRow* best = nullptr;
  double most = 0;
  for (const SweepRow& row : rows.rows) {
    const auto value = rows.number(row, goal.column);
    if (!value || (best != nullptr && (goal.maximise ? *value <= most : *value >= most))) continue;
    best = &row;
    most = *value;
  }
  if (best == nullptr || most == 0) return out;
  const std::optional<double> of_repeats = noise_of_repeats(rows, goal.column);
  std::size_t told = 0;
  while (told < rows.columns.size() && rows.columns[told].name != kNoiseColumn) ++told;
  const bool of_cycles =
      std::find(std::begin(kOfCycles), std::end(kOfCycles), rows.columns[goal.column].name) != std::end(kOfCycles);
  const auto noise_with = [&](const SweepRow& row) -> std::optional<double> {
    if (of_repeats || !of_cycles) return of_repeats;
    return noise_between(rows.number(*best, told), rows.number(row, told));
  };
  for (std::size_t i = 0; i < out.size(); ++i) {
    const auto value = rows.number(rows.rows[i], goal.column);
    if (!value || &rows.rows[i] == best) continue;
    const auto noise = noise_with(rows.rows[i]);
    out[i] = noise && std::abs(*value / most - 1) <= *noise;
  }
  return out;
}

}  // namespace carousel::app
