#include "report/accuracy/accuracy.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "core/numeric/exponential.h"
#include "core/numeric/student.h"
#include "report/accuracy/level_text.h"

namespace carousel::report {

namespace {

/// Part of a simulated machine's cycles by which they may differ and be equal, where one picture alone was traced.
constexpr double kSameCycles = 0.01;
/// Part by which accuracies and areas may differ and be equal.
constexpr double kSameAccuracy = 0.1, kSameArea = 0.01;

bool surely_cheaper(const Spread& a, const Spread& b) {
  return cost_ratio(a, b).high < 1;
}

/// The row of the least cost among those that `chosen` accepts.
template <class Chosen>
const AccuracyRow* cheapest(const std::vector<AccuracyRow>& rows, Clock clock, const Chosen& chosen) {
  const AccuracyRow* best = nullptr;
  for (const AccuracyRow& row : rows) {
    const std::optional<Spread> cost = row.cost(clock);
    if (!cost || !chosen(row)) continue;
    if (best == nullptr || cost->median < best->cost(clock)->median) best = &row;
  }
  return best;
}

/// The rows that `chosen` accepts and that cannot be told from the cheapest of them by cost, in order.
template <class Chosen>
std::vector<const AccuracyRow*> equals_of_cheapest(const std::vector<AccuracyRow>& rows, Clock clock,
                                                   const Chosen& chosen) {
  std::vector<const AccuracyRow*> equals;
  const AccuracyRow* const best = cheapest(rows, clock, chosen);
  if (best == nullptr) return equals;
  for (const AccuracyRow& row : rows)
    if (row.cost(clock) && chosen(row) && (&row == best || cost_ratio(*row.cost(clock), *best->cost(clock)).ties()))
      equals.push_back(&row);
  return equals;
}

/// Keeps those of the rows whose number is within `same` of the least.
template <class Number>
void keep_least(std::vector<const AccuracyRow*>& rows, double same, const Number& number) {
  double least = number(*rows.front());
  for (const AccuracyRow* row : rows) least = std::min(least, number(*row));
  std::erase_if(rows, [&](const AccuracyRow* row) { return number(*row) > least * (1 + same); });
}

template <class Chosen>
const AccuracyRow* best_of_equals(const std::vector<AccuracyRow>& rows, Clock clock, const Chosen& chosen) {
  std::vector<const AccuracyRow*> equals = equals_of_cheapest(rows, clock, chosen);
  if (equals.empty()) return nullptr;
  keep_least(equals, 0, [](const AccuracyRow& row) { return static_cast<double>(row.wrong()); });
  keep_least(equals, kSameAccuracy, [](const AccuracyRow& row) { return row.scene.ulp_p99; });
  keep_least(equals, kSameArea, [](const AccuracyRow& row) { return row.unit_area_mm2; });
  return equals.front();
}

bool is_safe(const AccuracyRow& row) {
  return row.safe;
}
bool is_safe_but_slivers(const AccuracyRow& row) {
  return row.safe_but_slivers;
}
bool any_row(const AccuracyRow&) {
  return true;
}

/// The other safe rows that cost the same, and how the choice between them was made.
std::string ties_text(const std::vector<AccuracyRow>& rows, Clock clock, const AccuracyRow& chosen) {
  std::string out;
  for (const AccuracyRow* row : equals_of_cheapest(rows, clock, is_safe)) {
    if (row == &chosen) continue;
    const CostRatio over = cost_ratio(*row->cost(clock), *chosen.cost(clock));
    out +=
        fmt::format("{}{} at {}{}", out.empty() ? "" : ", ", levels_text(*row), over_text(over), interval_text(over));
  }
  if (out.empty()) return out;
  return fmt::format(
      " It is a tie: the cost of the cheapest cannot be told from that of the others, {}. Of equals the choice is the "
      "more "
      "accurate t, then the smaller units, then the simpler tests.",
      out);
}

std::string sentences(const std::vector<AccuracyRow>& rows, Clock clock) {
  const bool host = clock == Clock::kHost;
  const AccuracyRow* const first = cheapest(rows, clock, any_row);
  if (first == nullptr) return host ? "" : "For hardware: the cycle engine cannot run the configured machine.";
  const std::string head = host ? "For this host: " : "For hardware, where its testers limit: ";
  const AccuracyRow* const safe = best_of_equals(rows, clock, is_safe);
  const auto over = [&](const AccuracyRow& row) { return cost_ratio(*row.cost(clock), *first->cost(clock)); };
  std::string out = head;
  if (safe == nullptr) {
    out += fmt::format("No combination is safe for this scene; the {}, {} ({}) {}.", host ? "fastest" : "cheapest",
                       levels_text(*first), cost_text(*first, clock), errors_text(*first));
  } else if (safe == first) {
    out += fmt::format("The cheapest safe level for this scene is also the {}: {} ({}).", host ? "fastest" : "cheapest",
                       levels_text(*safe), cost_text(*safe, clock));
  } else {
    out +=
        fmt::format("The cheapest safe level for this scene is {} at {}, {} over the {}{}; that one, {} ({}) {}.",
                    levels_text(*safe), cost_text(*safe, clock), over_text(over(*safe)), host ? "fastest" : "cheapest",
                    interval_text(over(*safe)), levels_text(*first), cost_text(*first, clock), errors_text(*first));
  }
  if (safe != nullptr) out += ties_text(rows, clock, *safe);
  const AccuracyRow* const thick = best_of_equals(rows, clock, is_safe_but_slivers);
  if (thick != nullptr && thick != safe)
    out += fmt::format(" Where slivers may be lost, {} will do at {}, {}{}: it {}.", levels_text(*thick),
                       cost_text(*thick, clock), over_text(over(*thick)), interval_text(over(*thick)),
                       errors_text(*thick));
  return out;
}

}  // namespace

Spread Spread::of(std::vector<double> samples) {
  if (samples.empty()) return {};
  std::vector<double> sorted = samples;
  std::sort(sorted.begin(), sorted.end());
  return {sorted[sorted.size() / 2], sorted.front(), sorted.back(), std::move(samples)};
}

CostRatio cost_ratio(const Spread& a, const Spread& b) {
  if (!(a.least > 0) || !(b.least > 0)) return {};  // nothing was traced
  const std::size_t pairs = std::min(a.samples.size(), b.samples.size());
  if (pairs < 2) return {a.median / b.median, a.least / b.most, a.most / b.least};
  std::vector<double> logs;
  for (std::size_t i = 0; i < pairs; ++i) logs.push_back(log_precise(a.samples[i] / b.samples[i]));
  const double count = static_cast<double>(pairs), mean = std::accumulate(logs.begin(), logs.end(), 0.0) / count;
  double squares = 0;
  for (const double x : logs) squares += (x - mean) * (x - mean);
  const double t = student_95(count - 1);
  const double half = t * std::sqrt(squares / (count - 1) / count);
  return {exp_precise(mean), exp_precise(mean - half), exp_precise(mean + half)};
}

void compare_costs(std::vector<AccuracyRow>& rows) {
  for (const Clock clock : kClocks) {
    const AccuracyRow* const least = cheapest(rows, clock, any_row);
    if (least == nullptr) continue;
    const Spread base = *least->cost(clock);
    for (AccuracyRow& row : rows)
      if (const std::optional<Spread> cost = row.cost(clock))
        row.over_cheapest[static_cast<std::size_t>(clock)] = cost_ratio(*cost, base);
  }
}

std::optional<Spread> AccuracyRow::cost(Clock clock) const {
  if (clock == Clock::kHost) return ns_per_ray;
  if (!modelled || !modelled->tester_limited) return std::nullopt;
  if (modelled->tester_limited->by_seed.size() >= 2) return Spread::of(modelled->tester_limited->by_seed);
  const double cycles = modelled->tester_limited->cycles_per_ray;
  return Spread{cycles, cycles * (1 - kSameCycles), cycles * (1 + kSameCycles)};
}

void judge_safety(AccuracyRow& row, const std::vector<HardCase>& hard) {
  std::uint64_t of_slivers = 0;
  for (std::size_t h = 0; h < hard.size(); ++h)
    if (hard[h].slivers) of_slivers += row.hard[h].wrong();
  row.safe = row.wrong() == 0;
  row.safe_but_slivers = row.wrong() == of_slivers;
}

void mark_frontier(std::vector<AccuracyRow>& rows) {
  for (const Clock clock : kClocks) {
    for (AccuracyRow& row : rows) {
      const std::optional<Spread> cost = row.cost(clock);
      row.frontier[static_cast<std::size_t>(clock)] =
          cost && std::none_of(rows.begin(), rows.end(), [&](const AccuracyRow& other) {
            const std::optional<Spread> others = other.cost(clock);
            if (!others) return false;
            return (surely_cheaper(*others, *cost) && other.wrong() <= row.wrong()) ||
                   (!surely_cheaper(*cost, *others) && other.wrong() < row.wrong());
          });
    }
  }
}

std::optional<std::size_t> recommended(const std::vector<AccuracyRow>& rows, Clock clock) {
  const AccuracyRow* const row = best_of_equals(rows, clock, is_safe);
  return row == nullptr ? std::nullopt : std::optional(static_cast<std::size_t>(row - rows.data()));
}

std::optional<std::size_t> cheapest_level(const std::vector<AccuracyRow>& rows, Clock clock) {
  const AccuracyRow* const row = cheapest(rows, clock, any_row);
  return row == nullptr ? std::nullopt : std::optional(static_cast<std::size_t>(row - rows.data()));
}

std::string accuracy_verdict(const std::vector<AccuracyRow>& rows) {
  if (rows.empty()) return "";
  return sentences(rows, Clock::kHost) + "\n" + sentences(rows, Clock::kHardware);
}

double log_log_slope(const std::vector<SamplingRow>& rows) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (const SamplingRow& row : rows) {
    if (row.rmse <= 0) continue;
    const double a = log_precise(static_cast<double>(row.samples)), b = log_precise(row.rmse);
    n += 1, x += a, y += b, xx += a * a, xy += a * b;
  }
  const double determinant = n * xx - x * x;
  return determinant > 0 ? (n * xy - x * y) / determinant : 0;
}

}  // namespace carousel::report
