#include "report/accuracy/accuracy_table.h"

#include <fmt/format.h>

#include "report/accuracy/accuracy_summary.h"
#include "report/schema/document_version.h"
#include "report/text/number_text.h"

namespace carousel::report {

namespace {

std::string cycles_text(const AccuracyRow& row) {
  return row.modelled ? fmt::format("{:.1f}", row.modelled->cycles_per_ray) : "-";
}

std::string limited_text(const AccuracyRow& row) {
  const std::optional<Spread> cost = row.cost(Clock::kHardware);
  return cost ? fmt::format("{:.3g}", cost->median) : "-";
}

/// The testers' cycles over those of the cheapest row, percent.
std::string limited_over_text(const AccuracyRow& row) {
  const auto& over = row.over_cheapest[static_cast<std::size_t>(Clock::kHardware)];
  return over ? fmt::format("{:+.1f}..{:+.1f}%", 100 * (over->low - 1), 100 * (over->high - 1)) : "-";
}

nlohmann::ordered_json range_json(const std::vector<double>& samples) {
  const Spread spread = Spread::of(samples);
  return {{"least", spread.least}, {"most", spread.most}};
}

std::string energy_text(const AccuracyRow& row) {
  return row.modelled ? fmt::format("{:.0f}", row.modelled->energy_pj_per_ray) : "-";
}

/// One of the two frontiers' marks each.
std::string marks(const AccuracyRow& row) {
  return std::string(row.on_frontier(Clock::kHost) ? "*" : " ") + (row.on_frontier(Clock::kHardware) ? "+" : " ");
}

std::string ulp_text(const HitErrors& e) {
  return fmt::format("{:.2g}/{:.3g}/{:.3g}", e.ulp_median, e.ulp_p99, e.ulp_max);
}

std::uint64_t hard_wrong(const AccuracyRow& row) {
  return row.wrong() - row.scene.wrong();
}

/// The units that limit the machine of `testers`, and how far they do.
void limit_lines(const Accuracy& a, std::string& out) {
  double least = 1;
  const AccuracyRow* worst = nullptr;
  for (const AccuracyRow& row : a.rows) {
    if (!row.modelled || !row.modelled->tester_limited) continue;
    if (const TesterLimited& t = *row.modelled->tester_limited; worst == nullptr || t.busy_fraction < least)
      least = t.busy_fraction, worst = &row;
  }
  if (worst != nullptr)
    out +=
        fmt::format("In the machine of the column testers one kind of units is busy {} of the time or more ({}: {}).\n",
                    percent(least), worst->triangle, worst->modelled->tester_limited->busiest);
  if (a.bundles) out += "The simulated machines trace bundles as configured; the host's times are of single rays.\n";
}

void level_lines(const Accuracy& a, std::string& out) {
  out += fmt::format(
      "{:<3}{:<11}{:<13}{:<22}{:>7}{:>11}{:>9}{:>18}{:>9}{:>6}{:>8}{:>8}{:>7}{:>7}  {:<20}{:>7}{:>8}{:>8}{:>9}{:>8}\n",
      "", "triangle", "box", "transform", "ns/ray", "least-most", "testers", "over least", "machine", "area", "pJ/ray",
      "missed", "extra", "other", "t error in ulp", "leaks", "hard", "pixels", "RMSE", "worst");
  for (const AccuracyRow& row : a.rows) {
    out += fmt::format(
        "{:<3}{:<11}{:<13}{:<22}{:>7.0f}{:>11}{:>9}{:>18}{:>9}{:>6.2f}{:>8}{:>8}{:>7}{:>7}  "
        "{:<20}{:>7}{:>8}{:>8}{:>9.2g}{:>8.2g}{}{}\n",
        marks(row), row.triangle, row.box, row.transform, row.ns_per_ray.median,
        fmt::format("{:.0f}-{:.0f}", row.ns_per_ray.least, row.ns_per_ray.most), limited_text(row),
        limited_over_text(row), cycles_text(row), row.relative_area, energy_text(row), grouped(row.scene.missed),
        grouped(row.scene.extra), grouped(row.scene.other), ulp_text(row.scene), grouped(row.leaks),
        grouped(hard_wrong(row)), grouped(row.picture.differ), row.picture.rmse, row.picture.worst,
        row.safe               ? "  safe"
        : row.safe_but_slivers ? "  safe but for slivers"
                               : "",
        a.planes && !row.cull_planes ? "  (without cull planes)" : "");
  }
  out +=
      "* on the frontier of the host's time, + of the testers' cycles: nothing is both cheaper and less often wrong;\n"
      "costs that pairs (of one repetition, of one seed of the picture) do not tell apart are equal. over least: the\n"
      "interval (95 %) of the testers' cycles over the least. ns/ray: CPU time of one thread, depth first, single\n"
      "rays. testers: cycles a ray of the configured machine with all but its test units relaxed; machine: as it is\n"
      "configured. area: box, triangle and transform units of a resource over those of the default levels; pJ/ray: "
      "energy\n"
      "of the tests' products and sums (45 nm). missed, extra, other: rays of the scene that miss where exact "
      "arithmetic\n"
      "hits, hit where it misses, hit another primitive; t error: median/p99/max; leaks: rays that get out of closed\n"
      "surfaces; hard: missed and extra hits of the hard cases; pixels that differ from the exact picture. safe: "
      "nothing\n"
      "missed or extra, in the scene and in the hard cases.\n";
  limit_lines(a, out);
}

void hard_lines(const Accuracy& a, std::string& out) {
  out += "\nhard cases: rays missed / extra / other\n";
  for (std::size_t h = 0; h < a.hard.size(); ++h) out += fmt::format("  {:<14}{}\n", a.hard[h].name, a.hard[h].what);
  out += fmt::format("{:<49}", "");
  for (const HardCase& c : a.hard) out += fmt::format("{:>18}", c.name);
  out += '\n';
  for (const AccuracyRow& row : a.rows) {
    out += fmt::format("{:<3}{:<11}{:<13}{:<22}", "", row.triangle, row.box, row.transform);
    for (const HitErrors& e : row.hard)
      out += fmt::format("{:>18}", fmt::format("{} / {} / {}", e.missed, e.extra, e.other));
    out += '\n';
  }
}

void spawn_lines(const Accuracy& a, std::string& out) {
  out += fmt::format("\n{:<10}{:>12}{:>12}{:>16}{:>16}{:>10}{:>10}\n", "spawn", "bounces", "self-hits", "far bounces",
                     "far self-hits", "pixels", "RMSE");
  for (const SpawnRow& row : a.spawn)
    out += fmt::format("{:<10}{:>12}{:>12}{:>16}{:>16}{:>10}{:>10.2g}\n", row.spawn, grouped(row.bounces),
                       grouped(row.self_hits), grouped(row.hard_bounces), grouped(row.hard_self_hits),
                       grouped(row.picture.differ), row.picture.rmse);
}

void sampling_lines(const Accuracy& a, std::string& out) {
  out += fmt::format("\n{:<10}{:>12}{:>12}\n", "samples", "RMSE", "time");
  for (const SamplingRow& row : a.sampling)
    out += fmt::format("{:<10}{:>12.4g}{:>12}\n", row.samples, row.rmse, seconds_text(row.seconds));
  out += "RMSE of the picture as shown, values in [0, 1], without the 2 % that are farthest off\n";
  out += fmt::format("It falls as samples to the power {:.2f} (Monte Carlo: -0.50)\n", a.sampling_slope);
}

nlohmann::ordered_json errors_json(const HitErrors& e) {
  return {{"rays", e.rays},
          {"missed", e.missed},
          {"extra", e.extra},
          {"other", e.other},
          {"opacity", e.opacity},
          {"t_error_ulp_median", e.ulp_median},
          {"t_error_ulp_p99", e.ulp_p99},
          {"t_error_ulp_max", e.ulp_max}};
}

nlohmann::ordered_json picture_json(const PictureErrors& p) {
  return {{"pixels", p.pixels}, {"differ", p.differ}, {"rmse", p.rmse}, {"worst", p.worst}};
}

nlohmann::ordered_json row_json(const AccuracyRow& row, const std::vector<HardCase>& cases) {
  nlohmann::ordered_json j{{"triangle", row.triangle}, {"box", row.box}, {"transform", row.transform}};
  j["ns_per_ray"] = {{"median", row.ns_per_ray.median}, {"least", row.ns_per_ray.least}, {"most", row.ns_per_ray.most}};
  if (row.modelled) {
    j["modelled_cycles_per_ray"] = row.modelled->cycles_per_ray;
    j["modelled_cycles_range"] = range_json(row.modelled->by_seed);
    j["modelled_tester_cycles_per_ray"] = row.modelled->tester_cycles_per_ray;
    if (const auto& limited = row.modelled->tester_limited) {
      j["tester_limited_cycles_per_ray"] = limited->cycles_per_ray;
      j["tester_limited_cycles_range"] = range_json(limited->by_seed);
      j["tester_limited_by"] = {{"units", limited->busiest}, {"busy_fraction", limited->busy_fraction}};
    }
    j["energy_pj_per_ray"] = row.modelled->energy_pj_per_ray;
    j["exact_volumes_per_ray"] = row.modelled->exact_volumes_per_ray;
    j["bundle_tests_per_ray"] = row.modelled->bundle_tests_per_ray;
    j["plane_tests_per_ray"] = row.modelled->plane_tests_per_ray;
  }
  j["unit_area_mm2"] = row.unit_area_mm2;
  j["unit_area_over_default"] = row.relative_area;
  j["cull_planes"] = row.cull_planes;
  j["scene"] = errors_json(row.scene);
  for (std::size_t h = 0; h < cases.size(); ++h) j["hard"][cases[h].name] = errors_json(row.hard[h]);
  j["leaks"] = row.leaks;
  j["picture"] = picture_json(row.picture);
  j["frontier"] = {{"host", row.on_frontier(Clock::kHost)}, {"hardware", row.on_frontier(Clock::kHardware)}};
  const auto over = [&](Clock clock) -> nlohmann::ordered_json {
    const auto& ratio = row.over_cheapest[static_cast<std::size_t>(clock)];
    if (!ratio) return nullptr;
    return {{"ratio", ratio->ratio}, {"low", ratio->low}, {"high", ratio->high}};
  };
  j["over_cheapest"] = {{"host", over(Clock::kHost)}, {"hardware", over(Clock::kHardware)}};
  j["safe"] = row.safe;
  j["safe_but_slivers"] = row.safe_but_slivers;
  return j;
}

}  // namespace

std::string accuracy_table(const Accuracy& a) {
  std::string out = accuracy_head(a) + "\n";
  level_lines(a, out);
  hard_lines(a, out);
  spawn_lines(a, out);
  sampling_lines(a, out);
  return out + "\n" + a.verdict + "\n";
}

nlohmann::ordered_json accuracy_json(const Accuracy& a) {
  nlohmann::ordered_json j{{"schema_version", kDocumentVersion},
                           {"incomplete", a.incomplete},
                           {"scene", a.scene},
                           {"triangles", a.triangles},
                           {"instances", a.instances},
                           {"rays", a.rays},
                           {"seed", a.seed},
                           {"repetitions", a.repetitions},
                           {"seeds", a.seeds}};
  j["picture"] = {{"width", a.width}, {"height", a.height}, {"samples", a.samples}};
  j["levels"] = nlohmann::ordered_json::array();
  for (const AccuracyRow& row : a.rows) j["levels"].push_back(row_json(row, a.hard));
  j["spawn"] = nlohmann::ordered_json::array();
  for (const SpawnRow& row : a.spawn)
    j["spawn"].push_back({{"spawn", row.spawn},
                          {"bounces", row.bounces},
                          {"self_hits", row.self_hits},
                          {"far_bounces", row.hard_bounces},
                          {"far_self_hits", row.hard_self_hits},
                          {"picture", picture_json(row.picture)}});
  j["sampling"] = {{"slope", a.sampling_slope}, {"rows", nlohmann::ordered_json::array()}};
  for (const SamplingRow& row : a.sampling)
    j["sampling"]["rows"].push_back({{"samples", row.samples}, {"rmse", row.rmse}, {"seconds", row.seconds}});
  const auto chosen = [&](Clock clock) -> nlohmann::ordered_json {
    const std::optional<std::size_t> row = a.recommended[static_cast<std::size_t>(clock)];
    if (!row) return nullptr;
    return {{"triangle", a.rows[*row].triangle}, {"box", a.rows[*row].box}, {"transform", a.rows[*row].transform}};
  };
  j["recommended"] = {{"host", chosen(Clock::kHost)}, {"hardware", chosen(Clock::kHardware)}};
  j["verdict"] = a.verdict;
  j["host"] = {{"machine", a.machine}};
  return j;
}

}  // namespace carousel::report
