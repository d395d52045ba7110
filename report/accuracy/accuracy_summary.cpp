#include "report/accuracy/accuracy_summary.h"

#include <algorithm>

#include <fmt/format.h>

#include "report/accuracy/level_text.h"
#include "report/text/number_text.h"
#include "report/text/singular.h"

namespace carousel::report {

namespace {

constexpr const char* kLine = "{:<9}{}\n";

const AccuracyRow* row_of(const Accuracy& a, std::optional<std::size_t> index) {
  return index ? &a.rows[*index] : nullptr;
}

const AccuracyRow* cheapest(const Accuracy& a, Clock clock) {
  return row_of(a, cheapest_level(a.rows, clock));
}

const AccuracyRow* safe(const Accuracy& a, Clock clock) {
  return row_of(a, a.recommended[static_cast<std::size_t>(clock)]);
}

/// The price of the safe level over the cheapest one, by a clock.
std::string price_text(const Accuracy& a, Clock clock) {
  const AccuracyRow* const least = cheapest(a, clock);
  if (least == nullptr) return "not measured: the cycle engine cannot run the configured machine";
  const AccuracyRow* const row = safe(a, clock);
  if (row == nullptr) return fmt::format("no level is safe here; the cheapest takes {}", cost_text(*least, clock));
  if (row == least) return fmt::format("the safe level takes {} and is the cheapest", cost_text(*row, clock));
  const CostRatio over = cost_ratio(*row->cost(clock), *least->cost(clock));
  if (over.ties())
    return fmt::format("the safe level takes {}, and its price over the cheapest cannot be told from none{}",
                       cost_text(*row, clock), interval_text(over));
  return fmt::format("the safe level takes {}, {} over the cheapest{}", cost_text(*row, clock), over_text(over),
                     interval_text(over));
}

/// The same for the machine as it is configured, where other parts may hide the price.
std::string configured_text(const Accuracy& a) {
  const AccuracyRow *const row = safe(a, Clock::kHardware), *const least = cheapest(a, Clock::kHardware);
  if (row == nullptr || row == least || !row->modelled || !least->modelled) return "";
  return fmt::format(" where testers limit; {:.3g} for {:.3g} as configured", row->modelled->cycles_per_ray,
                     least->modelled->cycles_per_ray);
}

std::string without_text(const Accuracy& a) {
  const AccuracyRow* least = cheapest(a, Clock::kHardware);
  if (least == nullptr) least = cheapest(a, Clock::kHost);
  return fmt::format("{} {}", levels_text(*least), errors_text(*least));
}

std::string settings_text(const AccuracyRow& row) {
  return fmt::format("accuracy: {{triangle: {}, box: {}, transform: {}}}", row.triangle, row.box, row.transform);
}

/// The settings of a row that are not those of another one.
std::string other_settings_text(const AccuracyRow& row, const AccuracyRow& other) {
  std::string out;
  const auto add = [&](const char* key, const std::string& value, const std::string& than) {
    if (value != than) out += fmt::format("{}{}: {}", out.empty() ? "" : ", ", key, value);
  };
  add("triangle", row.triangle, other.triangle);
  add("box", row.box, other.box);
  add("transform", row.transform, other.transform);
  return "{" + out + "}";
}

std::string advice_text(const Accuracy& a) {
  const AccuracyRow *const host = safe(a, Clock::kHost), *const machine = safe(a, Clock::kHardware);
  if (host == nullptr && machine == nullptr) return "none: each level gets something wrong";
  if (host == machine) return settings_text(*host);
  std::string out;
  if (host != nullptr) out = settings_text(*host) + " on this host";
  if (machine != nullptr)
    out += host != nullptr ? fmt::format("; {} on the machine", other_settings_text(*machine, *host))
                           : settings_text(*machine) + " on the machine";
  return out;
}

}  // namespace

std::string accuracy_head(const Accuracy& a) {
  return singular(fmt::format(
      "{}{}: {} triangles, {} instances; {} rays, {} repetitions, seed {}; pictures {} x {} x {}, {} seeds\n",
      a.incomplete ? "INCOMPLETE: interrupted; what follows is what was done\n" : "", a.scene, grouped(a.triangles),
      grouped(a.instances), grouped(a.rays), a.repetitions, a.seed, a.width, a.height, a.samples, a.seeds));
}

std::string accuracy_summary(const Accuracy& a) {
  std::string out = accuracy_head(a);
  if (a.rows.empty()) return out;
  out += fmt::format(fmt::runtime(kLine), "host", price_text(a, Clock::kHost));
  out += fmt::format(fmt::runtime(kLine), "machine", price_text(a, Clock::kHardware) + configured_text(a));
  out += fmt::format(fmt::runtime(kLine), "without", without_text(a));
  out += fmt::format(fmt::runtime(kLine), "advice", advice_text(a));
  return out;
}

}  // namespace carousel::report
