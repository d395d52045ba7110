#include "report/versus/versus.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <fmt/format.h>

#include "core/numeric/exponential.h"
#include "core/numeric/student.h"
#include "report/text/number_text.h"
#include "report/text/singular.h"

namespace carousel::report {

namespace {

struct Interval {
  double mean = 0;
  std::optional<double> half{};
};

/// The mean, and half of the interval of Student's distribution that holds it (95 %).
Interval interval_of(const std::vector<double>& values) {
  const double count = static_cast<double>(values.size());
  if (values.empty()) return {};
  Interval out{std::accumulate(values.begin(), values.end(), 0.0) / count, std::nullopt};
  if (values.size() < 2) return out;
  double squares = 0;
  for (const double x : values) squares += (x - out.mean) * (x - out.mean);
  const double t = student_95(count - 1);
  out.half = t * std::sqrt(squares / (count - 1) / count);
  return out;
}

std::string mean_text(const VersusMean& mean) {
  return mean.error ? fmt::format("{:.4g} ± {:.2g}", mean.mean, *mean.error) : fmt::format("{:.4g}", mean.mean);
}

std::string ratio_text(const VersusRatio& ratio) {
  if (!ratio.low) return fmt::format("{:.3f}", ratio.ratio);
  const double half = std::max(*ratio.high - ratio.ratio, ratio.ratio - *ratio.low);
  if (half < ratio.ratio) return fmt::format("{:.3f} ± {:.3f}", ratio.ratio, half);
  return fmt::format("{:.3f} ({:.2f} to {:.4g})", ratio.ratio, *ratio.low, *ratio.high);  // few runs that differ much
}

const VersusMachine* machine_named(const Versus& v, std::string_view name) {
  const auto at = std::find_if(v.machines.begin(), v.machines.end(), [&](const auto& m) { return m.name == name; });
  return at == v.machines.end() ? nullptr : &*at;
}
const VersusPair* pair_with(const Versus& v, std::string_view than) {
  const auto at = std::find_if(v.against.begin(), v.against.end(), [&](const auto& p) { return p.than == than; });
  return at == v.against.end() ? nullptr : &*at;
}

std::string class_words(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

std::string speed_line(const VersusMachine& machine, const VersusMachine& twin, const VersusPair& pair,
                       std::uint64_t seeds) {
  return fmt::format("{}: {} times as fast as its twin, {} over {} rays per kilocycle, {} seeds", pair.verdict,
                     ratio_text(pair.speed), mean_text(machine.rays_per_kilocycle), mean_text(twin.rays_per_kilocycle),
                     seeds);
}

std::string cost_line(const VersusMachine& machine, const VersusMachine& twin, const VersusPair& pair) {
  return fmt::format("memory bytes a ray {} times, {:.4g} over {:.4g}; joules {} times, {:.4g} over {:.4g} nJ",
                     ratio_text(pair.bytes), machine.memory_bytes_per_ray.mean, twin.memory_bytes_per_ray.mean,
                     ratio_text(pair.joules), machine.nj_per_ray.mean, twin.nj_per_ray.mean);
}

/// `drawn`: the machine has a drawing, which its twin of any size has not.
std::string area_line(const VersusMachine& machine, const VersusMachine* twin, const VersusPair* pair, bool drawn) {
  if (twin == nullptr || pair == nullptr)
    return fmt::format("at equal area: no twin of any size is within {:.4g} mm2", machine.mm2);
  return fmt::format(
      "{} at equal area, {} times as fast: the twin has {} resources in {:.4g} mm2, this machine {} in "
      "{:.4g}{}",
      pair->verdict, ratio_text(pair->speed), twin->resources, twin->mm2, machine.resources, machine.mm2,
      drawn ? "; that twin is not drawn" : "");
}

/// The class of the slower machine that gains most; where none was looked for, the tightest bounds of both.
std::string part_line(const Versus& v, const VersusMachine& machine, const VersusMachine& twin) {
  if (!v.turns.empty())
    return fmt::format("{} decides in the slower one, the {}: {} gives {:+.1f} %", class_words(v.turns.front().name),
                       v.slower == "twin" ? "twin" : "machine", v.turns.front().action, 100 * v.turns.front().gain);
  const auto bound = [](const VersusMachine& m) {
    return fmt::format("{} ({} of its bound)", class_words(m.limits), percent(m.reached));
  };
  return fmt::format("busiest: of this machine {}, of the twin {}", bound(machine), bound(twin));
}

std::string turn_line(const Versus& v, const VersusPair& pair) {
  if (v.turns.empty()) return "what would turn it round: not looked for";
  const bool twin = v.slower == "twin";
  const char* other = twin ? "this machine" : "the twin";
  const auto turns = std::count_if(v.turns.begin(), v.turns.end(), [](const VersusTurn& t) { return t.speed > 1; });
  const VersusTurn& best = v.turns.front();
  if (pair.verdict == "alike")
    return fmt::format("nothing to turn round; with {} {} would be {:.3f} times as fast as {}", best.action,
                       twin ? "the twin" : "this machine", best.speed, other);
  if (turns == 0)
    return fmt::format(
        "no part of {} that were relaxed alone would turn it round; {} brings it to {:.3f} times the "
        "speed of {}",
        v.turns.size(), best.action, best.speed, other);
  return fmt::format("turned round by {}: {:.3f} times as fast as {} then{}", best.action, best.speed, other,
                     turns < 2    ? ""
                     : turns == 2 ? "; so does one other"
                                  : fmt::format("; so do {} others", turns - 1));
}

}  // namespace

VersusMean versus_mean(const std::vector<double>& values) {
  const Interval of = interval_of(values);
  return {of.mean, of.half};
}

VersusRatio versus_ratio(const std::vector<double>& ours, const std::vector<double>& theirs) {
  std::vector<double> logs;
  for (std::size_t i = 0; i < std::min(ours.size(), theirs.size()); ++i)
    if (ours[i] > 0 && theirs[i] > 0) logs.push_back(log_precise(ours[i] / theirs[i]));
  if (logs.empty()) return {};
  const Interval of = interval_of(logs);
  VersusRatio out{exp_precise(of.mean), std::nullopt, std::nullopt};
  if (of.half) {
    out.low = exp_precise(of.mean - *of.half);
    out.high = exp_precise(of.mean + *of.half);
  }
  return out;
}

std::vector<std::string> versus_lines(const Versus& v) {
  const VersusMachine *machine = machine_named(v, "machine"), *twin = machine_named(v, "twin");
  const VersusPair* pair = pair_with(v, "twin");
  if (machine == nullptr || twin == nullptr || pair == nullptr) return {};
  std::vector<std::string> lines{speed_line(*machine, *twin, *pair, v.seeds), cost_line(*machine, *twin, *pair),
                                 area_line(*machine, machine_named(v, "twin_at_equal_area"),
                                           pair_with(v, "twin_at_equal_area"), v.drawing.has_value()),
                                 part_line(v, *machine, *twin), turn_line(v, *pair)};
  for (std::string& line : lines) line = singular(line);
  return lines;
}

}  // namespace carousel::report
