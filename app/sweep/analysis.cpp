#include "app/sweep/analysis.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "core/numeric/student.h"
#include "core/system/error.h"

namespace carousel::app {

namespace {

constexpr std::size_t kMostLevels = 8, kParts = 4;
constexpr int kMostRounds = 500;

/// A key as a factor: the number of its level in each row.
struct Factor {
  std::string key;
  std::vector<std::string> names;
  std::vector<std::size_t> level;
};

std::string text_of(const SweepRow& row, const std::string& key) {
  for (const KeyValue& k : row.point.keys)
    if (k.first == key) return k.second;
  return "";
}

Factor factor_of(const std::vector<const SweepRow*>& rows, const std::string& key) {
  Factor out{key, {}, {}};
  std::vector<std::string> texts;
  bool numeric = true;
  for (const SweepRow* row : rows) {
    texts.push_back(text_of(*row, key));
    numeric &= number_of(texts.back()).has_value();
    if (std::find(out.names.begin(), out.names.end(), texts.back()) == out.names.end())
      out.names.push_back(texts.back());
  }
  const auto by_number = [](const std::string& a, const std::string& b) { return *number_of(a) < *number_of(b); };
  if (numeric) std::sort(out.names.begin(), out.names.end(), by_number);
  if (!numeric || out.names.size() <= kMostLevels) {
    for (const std::string& text : texts)
      out.level.push_back(
          static_cast<std::size_t>(std::find(out.names.begin(), out.names.end(), text) - out.names.begin()));
    return out;
  }
  std::vector<std::size_t> order(rows.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return by_number(texts[a], texts[b]); });
  out.names.clear();
  out.level.resize(rows.size());
  for (std::size_t part = 0; part < kParts; ++part) {
    const std::size_t begin = part * order.size() / kParts, end = (part + 1) * order.size() / kParts;
    out.names.push_back(texts[order[begin]] + ".." + texts[order[end - 1]]);
    for (std::size_t i = begin; i < end; ++i) out.level[order[i]] = part;
  }
  return out;
}

double mean_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

}  // namespace

std::vector<Goal> parse_goals(const SweepRows& rows, const std::string& text) {
  const std::string option = "--pareto " + text;
  std::vector<Goal> out;
  for (std::string name : split_outside(text, ',')) {
    std::optional<bool> maximise;
    if (name.rfind("max:", 0) == 0) maximise = true;
    if (name.rfind("min:", 0) == 0) maximise = false;
    if (maximise) name = name.substr(4);
    const std::size_t column = rows.column(name, option);
    out.push_back({column, maximise.value_or(rows.columns[column].greater_is_better)});
  }
  if (out.size() != 2)
    throw ConfigError(
        {{{option, 0, 0}, "", fmt::format("expected two results, as in cycles,bytes, found {}", out.size())}});
  return out;
}

std::vector<std::size_t> pareto_front(const SweepRows& rows, const std::vector<Goal>& goals) {
  struct Place {
    std::size_t row;
    std::vector<double> values;  // less is better
  };
  std::vector<Place> places;
  for (std::size_t i = 0; i < rows.rows.size(); ++i) {
    Place place{i, {}};
    for (const Goal& goal : goals)
      if (const auto value = rows.number(rows.rows[i], goal.column))
        place.values.push_back(goal.maximise ? -*value : *value);
    if (place.values.size() == goals.size()) places.push_back(std::move(place));
  }
  const auto betters = [](const Place& a, const Place& b) {
    bool less = false;
    for (std::size_t i = 0; i < a.values.size(); ++i) {
      if (a.values[i] > b.values[i]) return false;
      less |= a.values[i] < b.values[i];
    }
    return less;
  };
  std::vector<Place> front;
  for (const Place& place : places)
    if (std::none_of(places.begin(), places.end(), [&](const Place& other) { return betters(other, place); }))
      front.push_back(place);
  std::stable_sort(front.begin(), front.end(), [](const Place& a, const Place& b) { return a.values < b.values; });
  std::vector<std::size_t> out;
  for (const Place& place : front) out.push_back(place.row);
  return out;
}

std::vector<MainEffect> main_effects(const SweepRows& all, std::size_t column) {
  std::vector<const SweepRow*> rows;
  std::vector<double> y;
  for (const SweepRow& row : all.rows)
    if (const auto value = all.number(row, column)) {
      rows.push_back(&row);
      y.push_back(*value);
    }
  if (y.size() < 2) return {};
  std::vector<Factor> factors;
  for (const std::string& key : all.keys) {
    Factor factor = factor_of(rows, key);
    const bool twin =
        std::any_of(factors.begin(), factors.end(), [&](const Factor& f) { return f.level == factor.level; });
    if (factor.names.size() > 1 && !twin) factors.push_back(std::move(factor));  // paired keys have one effect
  }
  // Backfitting: each factor in turn takes the mean of what the others leave, until nothing changes.
  const double mean = mean_of(y);
  std::vector<double> residual;
  for (const double value : y) residual.push_back(value - mean);
  std::vector<std::vector<double>> effects;
  for (const Factor& factor : factors) effects.emplace_back(factor.names.size(), 0.0);
  for (int round = 0; round < kMostRounds; ++round) {
    double change = 0;
    for (std::size_t f = 0; f < factors.size(); ++f) {
      std::vector<double> sum(factors[f].names.size(), 0.0), count(sum.size(), 0.0);
      for (std::size_t i = 0; i < y.size(); ++i) {
        sum[factors[f].level[i]] += residual[i];
        count[factors[f].level[i]] += 1;
      }
      for (std::size_t level = 0; level < sum.size(); ++level) {
        sum[level] /= count[level];
        effects[f][level] += sum[level];
        change = std::max(change, std::abs(sum[level]));
      }
      for (std::size_t i = 0; i < y.size(); ++i) residual[i] -= sum[factors[f].level[i]];
    }
    if (change <= 1e-12 * std::abs(mean)) break;
  }
  double squares = 0, freedom = static_cast<double>(y.size()) - 1;
  for (const double value : residual) squares += value * value;
  for (const Factor& factor : factors) freedom -= static_cast<double>(factor.names.size()) - 1;
  std::vector<MainEffect> out;
  for (std::size_t f = 0; f < factors.size(); ++f) {
    MainEffect effect{factors[f].key, all.columns[column].name, mean, {}};
    for (std::size_t level = 0; level < factors[f].names.size(); ++level) {
      const auto points = static_cast<std::size_t>(std::count(factors[f].level.begin(), factors[f].level.end(), level));
      LevelEffect one{factors[f].names[level], points, effects[f][level], std::nullopt};
      if (freedom >= 1) {
        const double t = student_95(freedom);
        one.half_width = t * std::sqrt(squares / freedom * (1 / double(points) - 1 / double(y.size())));
      }
      effect.levels.push_back(std::move(one));
    }
    out.push_back(std::move(effect));
  }
  return out;
}

}  // namespace carousel::app
