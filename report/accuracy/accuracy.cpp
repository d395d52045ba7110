#include "report/accuracy/accuracy.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include <fmt/format.h>

#include "report/text/number_text.h"

namespace carousel::report {

namespace {

/// Part of a simulated machine's cycles by which they may differ and be equal.
constexpr double kSameCycles = 0.01;

std::string levels_text(const AccuracyRow& row) {
  return fmt::format("{} + {} + {}", row.triangle, row.box, row.transform);
}

bool surely_cheaper(const Spread& a, const Spread& b) {
  return a.most < b.least;
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

template <class Chosen>
const AccuracyRow* best_of_equals(const std::vector<AccuracyRow>& rows, Clock clock, const Chosen& chosen) {
  const AccuracyRow* best = cheapest(rows, clock, chosen);
  if (best == nullptr) return nullptr;
  const Spread least = *best->cost(clock);
  const auto merit = [](const AccuracyRow& row) {
    return std::tuple(row.wrong(), row.scene.ulp_p99, row.unit_area_mm2);
  };
  for (const AccuracyRow& row : rows) {
    const std::optional<Spread> cost = row.cost(clock);
    if (cost && chosen(row) && !surely_cheaper(least, *cost) && merit(row) < merit(*best)) best = &row;
  }
  return best;
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

std::string cost_text(const AccuracyRow& row, Clock clock) {
  const double cost = row.cost(clock)->median;
  return clock == Clock::kHost ? fmt::format("{:.0f} ns a ray", cost) : fmt::format("{:.3g} cycles a ray", cost);
}

std::string errors_text(const AccuracyRow& row) {
  return fmt::format("leaks {}, answers {} of {} rays of the scene and {} of the hard cases wrongly",
                     grouped(row.leaks), grouped(row.scene.wrong()), grouped(row.scene.rays),
                     grouped(row.wrong() - row.scene.wrong()));
}

std::string sentences(const std::vector<AccuracyRow>& rows, Clock clock) {
  const bool host = clock == Clock::kHost;
  const AccuracyRow* const first = cheapest(rows, clock, any_row);
  if (first == nullptr) return host ? "" : "For hardware: the cycle engine cannot run the configured machine.";
  const std::string head = host ? "For this host: " : "For hardware, where its testers limit: ";
  const AccuracyRow* const safe = best_of_equals(rows, clock, is_safe);
  const double least = first->cost(clock)->median;
  std::string out = head;
  if (safe == nullptr) {
    out += fmt::format("No combination is safe for this scene; the {}, {} ({}) {}.", host ? "fastest" : "cheapest",
                       levels_text(*first), cost_text(*first, clock), errors_text(*first));
  } else if (safe == first) {
    out += fmt::format("The cheapest safe level for this scene is also the {}: {} ({}).", host ? "fastest" : "cheapest",
                       levels_text(*safe), cost_text(*safe, clock));
  } else {
    out +=
        fmt::format("The cheapest safe level for this scene is {} at {}, {:+.0f} % over the {}; that one, {} ({}) {}.",
                    levels_text(*safe), cost_text(*safe, clock), 100 * (safe->cost(clock)->median / least - 1),
                    host ? "fastest" : "cheapest", levels_text(*first), cost_text(*first, clock), errors_text(*first));
  }
  const AccuracyRow* const thick = best_of_equals(rows, clock, is_safe_but_slivers);
  if (thick != nullptr && thick != safe)
    out += fmt::format(" Where slivers may be lost, {} will do at {}, {:+.0f} %: it {}.", levels_text(*thick),
                       cost_text(*thick, clock), 100 * (thick->cost(clock)->median / least - 1), errors_text(*thick));
  return out;
}

}  // namespace

std::optional<Spread> AccuracyRow::cost(Clock clock) const {
  if (clock == Clock::kHost) return ns_per_ray;
  if (!modelled || !modelled->tester_limited) return std::nullopt;
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

std::string accuracy_verdict(const std::vector<AccuracyRow>& rows) {
  if (rows.empty()) return "";
  return sentences(rows, Clock::kHost) + "\n" + sentences(rows, Clock::kHardware);
}

double log_log_slope(const std::vector<SamplingRow>& rows) {
  double n = 0, x = 0, y = 0, xx = 0, xy = 0;
  for (const SamplingRow& row : rows) {
    if (row.rmse <= 0) continue;
    const double a = std::log(static_cast<double>(row.samples)), b = std::log(row.rmse);
    n += 1, x += a, y += b, xx += a * a, xy += a * b;
  }
  const double determinant = n * xx - x * x;
  return determinant > 0 ? (n * xy - x * y) / determinant : 0;
}

}  // namespace carousel::report
