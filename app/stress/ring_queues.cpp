#include "app/stress/ring_queues.h"

#include <algorithm>

#include <fmt/format.h>

#include "app/run/render_job.h"
#include "core/config/config.h"
#include "core/types/enum_names.h"
#include "report/text/number_text.h"
#include "report/text/ratio.h"
#include "ringbus/native/native_engine.h"

namespace carousel::app {

namespace {

/// One cell: a kind at a depth, with the results of its runs.
struct Cell {
  QueueKind kind;
  std::int64_t depth;
  std::vector<double> rates;
  std::uint64_t packets = 0, refusals = 0, occupancy = 0, samples = 0;
  bool same_digest = true;
};

struct Digests {
  std::string hits, image;
  friend bool operator==(const Digests&, const Digests&) = default;
};

Digests run_cell(const Prepared& p, Cell& cell, const std::stop_token& stop) {
  Config config = p.config();
  config.engine.kind = EngineKind::kNative;
  config.topology.link.queue = cell.kind;
  config.topology.link.depth = cell.depth;
  RenderJob job(p, config);
  ringbus::RunOptions options;
  options.threads = p.threads;
  options.stop = stop;
  const ringbus::RunResult result = ringbus::run_native(config, p.accel, p.scene_size(), job.workload(), options);
  if (!result.complete) return {};
  cell.rates.push_back(report::ratio(result.rays_completed, result.wall_seconds));
  for (const ringbus::LinkResult& link : result.links) {
    cell.packets += link.statistics.packets;
    cell.refusals += link.statistics.refusals;
    cell.occupancy += link.statistics.occupancy_sum;
    cell.samples += link.statistics.samples;
  }
  return {job.hits_digest(), job.image_digest().value_or("")};
}

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return (values[(values.size() - 1) / 2] + values[values.size() / 2]) / 2;
}

}  // namespace

std::vector<report::StressRingRow> try_in_ring(const Prepared& p, const std::vector<QueueKind>& kinds,
                                               const std::vector<std::int64_t>& depths, std::size_t repetitions,
                                               std::stop_token stop, const std::function<void(double part)>& progress) {
  std::vector<Cell> cells;
  for (const QueueKind kind : kinds)
    for (const std::int64_t depth : depths) cells.push_back({kind, depth, {}});
  std::optional<Digests> expected;
  double done = 0;
  for (std::size_t repetition = 0; repetition < repetitions; ++repetition)
    for (std::size_t k = 0; k < cells.size() && !stop.stop_requested(); ++k) {
      // Each repetition begins with another cell, so that no cell always follows the same one.
      Cell& cell = cells[(k + repetition * (cells.size() / repetitions + 1)) % cells.size()];
      const Digests digests = run_cell(p, cell, stop);
      if (stop.stop_requested()) break;
      if (!expected) expected = digests;
      cell.same_digest &= digests == *expected;
      progress(++done / static_cast<double>(cells.size() * repetitions));
    }

  std::vector<report::StressRingRow> rows;
  double best = 0;
  for (const Cell& cell : cells) best = std::max(best, median(cell.rates));
  for (const Cell& cell : cells) {
    if (cell.rates.empty()) continue;
    report::StressRingRow& row = rows.emplace_back();
    row.queue = enum_name(cell.kind);
    row.depth = static_cast<std::uint64_t>(cell.depth);
    row.rate_median = median(cell.rates);
    row.rate_least = *std::min_element(cell.rates.begin(), cell.rates.end());
    row.rate_most = *std::max_element(cell.rates.begin(), cell.rates.end());
    row.relative = report::ratio(row.rate_median, best);
    row.refused = report::ratio(cell.refusals, cell.packets + cell.refusals);
    row.occupancy_mean = report::ratio(cell.occupancy, cell.samples);
    row.same_digest = cell.same_digest;
  }
  return rows;
}

std::string ring_verdict(const std::vector<report::StressRingRow>& rows) {
  if (rows.empty()) return "";
  const auto slower = [](const auto& a, const auto& b) { return a.rate_median < b.rate_median; };
  const auto [worst, best] = std::minmax_element(rows.begin(), rows.end(), slower);
  double spread = 0;  // between repetitions of one cell
  for (const report::StressRingRow& row : rows)
    spread = std::max(spread, report::ratio(row.rate_most - row.rate_least, row.rate_median));
  const auto named = [](const report::StressRingRow& row) {
    return fmt::format("{} of depth {}", row.queue, row.depth);
  };
  const double gain = report::ratio(best->rate_median, worst->rate_median) - 1;
  // The cells differ if the worst cell's best repetition is below the best cell's worst.
  const bool sure = worst->rate_most < best->rate_least;
  std::string text = fmt::format("{} traces {} rays/s, {} {}: {} more", named(*best), report::scaled(best->rate_median),
                                 named(*worst), report::scaled(worst->rate_median), report::percent(gain));
  text += fmt::format("; repetitions of one cell differ by up to {}, so this is {}", report::percent(spread),
                      sure ? "no accident" : "not sure");
  return text;
}

}  // namespace carousel::app
