#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include <fmt/format.h>

#include "app/sweep/noise.h"
#include "app/sweep/sweep_files.h"
#include "report/text/number_text.h"

namespace carousel::app {

namespace {

constexpr std::size_t kRowsOfTable = 30;

/// The shortest ending of a key, from a dot on, that no other varied key has.
std::string short_name(const std::string& key, const std::vector<std::string>& keys) {
  for (std::size_t dot = key.rfind('.'); dot != key.npos && dot > 0; dot = key.rfind('.', dot - 1)) {
    const std::string ending = key.substr(dot);
    const auto same = std::count_if(keys.begin(), keys.end(), [&](const std::string& k) {
      return k.size() >= ending.size() && k.compare(k.size() - ending.size(), ending.size(), ending) == 0;
    });
    if (same == 1) return ending.substr(1);
  }
  return key;
}

std::string shown(const nlohmann::ordered_json& value) {
  if (value.is_null()) return "-";
  if (value.is_string()) return value.get<std::string>();
  if (value.is_number_unsigned()) return report::grouped(value.get<std::uint64_t>());
  if (value.is_number()) return fmt::format("{:.4g}", value.get<double>());
  return value.dump();
}

/// Columns of text, right-aligned but for the first; those that do not fit are left out and named.
std::string columns_text(std::vector<std::vector<std::string>> columns, std::size_t width, std::size_t keep) {
  std::vector<std::size_t> widths;
  for (const auto& column : columns) {
    std::size_t most = 0;
    for (const std::string& cell : column) most = std::max(most, cell.size());
    widths.push_back(most + 2);
  }
  std::vector<std::string> left_out;
  while (columns.size() > keep && std::accumulate(widths.begin(), widths.end(), std::size_t{0}) > width) {
    left_out.insert(left_out.begin(), columns.back().front());
    columns.pop_back();
    widths.pop_back();
  }
  std::string out;
  for (std::size_t row = 0; row < columns.front().size(); ++row) {
    std::string line;
    for (std::size_t i = 0; i < columns.size(); ++i) line += fmt::format("{:>{}}", columns[i][row], widths[i]);
    out += line.substr(0, width) + "\n";
  }
  if (!left_out.empty()) out += fmt::format("  (no room here for {})\n", fmt::join(left_out, ", "));
  return out;
}

/// The columns of results with those of the goals first, which are shown however narrow the terminal is.
std::vector<std::size_t> column_order(const SweepRows& rows, const std::vector<Goal>& goals) {
  std::vector<std::size_t> order;
  for (const Goal& goal : goals) order.push_back(goal.column);
  for (std::size_t i = 0; i < rows.columns.size(); ++i)
    if (std::find(order.begin(), order.end(), i) == order.end()) order.push_back(i);
  return order;
}

/// `ties`: rows whose first result is marked.
std::string rows_text(const SweepRows& rows, const std::vector<std::size_t>& chosen, const std::vector<Goal>& goals,
                      const std::vector<bool>& ties, std::size_t width) {
  std::vector<std::vector<std::string>> columns;
  for (std::size_t k = 0; k < rows.keys.size(); ++k) {
    auto& column = columns.emplace_back(1, short_name(rows.keys[k], rows.keys));
    for (const std::size_t row : chosen) column.push_back(rows.rows[row].point.keys[k].second);
  }
  const std::vector<std::size_t> order = column_order(rows, goals);
  for (const std::size_t i : order) {
    auto& column = columns.emplace_back(1, rows.columns[i].name);
    for (const std::size_t row : chosen) {
      const SweepRow& r = rows.rows[row];
      const std::string none = i != order.front() ? "-" : r.error ? "failed" : "missing";
      const char* mark = i == order.front() && ties[row] ? "~" : "";
      column.push_back(i < r.results.size() ? mark + shown(r.results[i]) : none);
    }
  }
  return columns.empty()
             ? ""
             : columns_text(std::move(columns), width, rows.keys.size() + std::max<std::size_t>(1, goals.size()));
}

std::string effects_text(const SweepRows& rows, std::size_t column, std::size_t width) {
  std::string out;
  for (const MainEffect& effect : main_effects(rows, column)) {
    for (std::size_t i = 0; i < effect.levels.size(); ++i) {
      const LevelEffect& level = effect.levels[i];
      const double share = effect.mean == 0 ? 0 : 100 / effect.mean;
      const std::string name = i == 0 ? short_name(effect.key, rows.keys) : "";
      std::string line = fmt::format("  {:<24} {:>16}  {:+7.2f} %", name, level.level, level.effect * share);
      if (level.half_width) line += fmt::format("  +- {:.2f} %", std::abs(*level.half_width * share));
      out += line.substr(0, width) + "\n";
    }
  }
  return out;
}

}  // namespace

std::string sweep_table(const SweepRows& rows, const std::vector<Goal>& goals, std::size_t width) {
  // Best first, by the first result; points without it last.
  std::vector<std::size_t> order(rows.rows.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const Goal goal = !goals.empty()         ? goals.front()
                    : rows.columns.empty() ? Goal{}
                                           : Goal{0, rows.columns.front().greater_is_better};
  const auto rank = [&](std::size_t row) {
    const auto value = rows.number(rows.rows[row], goal.column);
    return value ? (goal.maximise ? -*value : *value) : std::numeric_limits<double>::infinity();
  };
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return rank(a) < rank(b); });
  std::string out;
  if (order.size() > kRowsOfTable) {
    out += fmt::format("The best {} of {} points by {}:\n", kRowsOfTable, order.size(), rows.columns[goal.column].name);
    order.resize(kRowsOfTable);
  }
  const std::vector<bool> ties = ties_with_best(rows, goal);
  out += rows_text(rows, order, goals, ties, width);
  if (std::find(ties.begin(), ties.end(), true) != ties.end())
    out += fmt::format("~ another seed of the picture may turn the order with the best {} round\n",
                       rows.columns[goal.column].name);
  if (!goals.empty()) {
    out += fmt::format("\nPareto front of {} and {}:\n", rows.columns[goals[0].column].name,
                       rows.columns[goals[1].column].name);
    out += rows_text(rows, pareto_front(rows, goals), goals, ties, width);
  }
  if (rows.columns.empty()) return out;
  if (const std::string effects = effects_text(rows, goal.column, width); !effects.empty())
    out += fmt::format("\nMain effects on {}, as shares of its mean, with intervals of 95 %:\n{}",
                       rows.columns[goal.column].name, effects);
  return out;
}

}  // namespace carousel::app
