#include "app/stress/ring_queues.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "app/run/render_job.h"
#include "core/config/config.h"
#include "core/types/enum_names.h"
#include "report/text/number_text.h"
#include "report/text/ratio.h"
#include "ringbus/native/native_engine.h"
#include "ringbus/stress/paired_rates.h"

namespace carousel::app {

namespace {

/// One cell: a kind at a depth, with the results of its runs.
struct Cell {
  QueueKind kind;
  std::int64_t depth;
  std::vector<double> rates;
  QueueUse use{};
  bool same_digest = true;
};

struct Digests {
  std::string hits, image;
  friend bool operator==(const Digests&, const Digests&) = default;
};

QueueUse use_of_links(const ringbus::RunResult& result) {
  QueueUse sum;
  for (const ringbus::LinkResult& link : result.links) {
    const ringbus::LinkStatistics& s = link.statistics;
    sum += {link.depth, s.packets, 0, s.refusals, 0, s.occupancy_max};
    // Links look at some of their sends only.
    if (s.samples > 0) sum.waiting_sum += s.occupancy_sum * s.packets / s.samples;
  }
  return sum;
}

constexpr auto kRingPlaces = std::to_array<RingPlace>({
    {"topology.link.queue", "topology.link.depth",
     [](Config& c, QueueKind kind, std::int64_t depth) {
       c.topology.link.queue = kind;
       c.topology.link.depth = depth;
     },
     [](const Config& c) { return c.topology.link.depth; }, use_of_links},
    {"shading.queue", "shading.queue_depth",
     [](Config& c, QueueKind kind, std::int64_t depth) {
       c.shading.queue = {kind, depth};
     },
     [](const Config& c) { return c.shading.queue.depth; },
     [](const ringbus::RunResult& result) { return result.completed; }},
    {"rays.queue", "rays.queue_depth",
     [](Config& c, QueueKind kind, std::int64_t depth) {
       c.rays.queue = {kind, depth};
     },
     [](const Config& c) { return c.rays.queue.depth; },
     [](const ringbus::RunResult& result) { return result.groups; }},
});

Digests run_cell(const Prepared& p, const RingPlace& place, Cell& cell, const std::stop_token& stop) {
  Config config = p.config();
  config.engine.kind = EngineKind::kNative;
  place.choose(config, cell.kind, cell.depth);
  RenderJob job(p, config);
  ringbus::RunOptions options;
  options.threads = p.threads;
  options.stop = stop;
  const ringbus::RunResult result = ringbus::run_native(config, p.accel, p.scene_size(), job.workload(), options);
  if (!result.complete) return {};
  cell.rates.push_back(report::ratio(result.rays_completed, result.wall_seconds));
  cell.use += place.use(result);
  return {job.hits_digest(), job.image_digest().value_or("")};
}

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return (values[(values.size() - 1) / 2] + values[values.size() / 2]) / 2;
}

/// Tries the cells of one configuration.
class RingCells {
 public:
  RingCells(const Prepared& prepared, const RingTrial& trial) : prepared_(prepared), trial_(trial) {
    for (const QueueKind kind : trial.kinds)
      for (const std::int64_t depth : trial.depths) cells_.push_back({kind, depth, {}});
    paired_ = cells_.size() > 1 ? trial.pairs : 0;
  }

  void repeat_all() {
    const std::size_t count = cells_.size(), repetitions = trial_.repetitions;
    for (std::size_t repetition = 0; repetition < repetitions; ++repetition)
      for (std::size_t k = 0; k < count; ++k)
        // Each repetition begins with another cell, so that no cell always follows the same one.
        if (!run(cells_[(k + repetition * (count / repetitions + 1)) % count])) return;
  }

  std::optional<report::StressPairs> compare_best_and_worst() {
    if (paired_ == 0 || trial_.stop.stop_requested()) return std::nullopt;
    const auto slower = [](const Cell* a, const Cell* b) { return median(a->rates) < median(b->rates); };
    std::vector<Cell*> cells;
    for (Cell& cell : cells_) cells.push_back(&cell);
    Cell* const best = *std::max_element(cells.begin(), cells.end(), slower);
    // A deep queue against a shallow one would say little about their designs.
    if (trial_.kinds.size() > 1) std::erase_if(cells, [&](const Cell* cell) { return cell->depth != best->depth; });
    Cell* const worst = *std::min_element(cells.begin(), cells.end(), slower);
    std::vector<ringbus::stress::RatePair> pairs;
    Cell fast{best->kind, best->depth, {}}, slow{worst->kind, worst->depth, {}};
    for (std::size_t i = 0; i < paired_; ++i) {
      if (!run(i % 2 == 0 ? fast : slow) || !run(i % 2 == 0 ? slow : fast)) break;
      pairs.push_back({fast.rates.back(), slow.rates.back()});
    }
    best->same_digest &= fast.same_digest;
    worst->same_digest &= slow.same_digest;
    return pairs_section(fast, slow, ringbus::stress::compare_pairs(pairs));
  }

  std::vector<report::StressRingRow> rows() const {
    std::vector<report::StressRingRow> rows;
    double best = 0;
    for (const Cell& cell : cells_) best = std::max(best, median(cell.rates));
    for (const Cell& cell : cells_) {
      if (cell.rates.empty()) continue;
      report::StressRingRow& row = rows.emplace_back();
      row.queue = enum_name(cell.kind);
      row.depth = static_cast<std::uint64_t>(cell.depth);
      row.rate_median = median(cell.rates);
      row.rate_least = *std::min_element(cell.rates.begin(), cell.rates.end());
      row.rate_most = *std::max_element(cell.rates.begin(), cell.rates.end());
      row.relative = report::ratio(row.rate_median, best);
      row.refused = report::ratio(cell.use.refusals, cell.use.sent + cell.use.refusals);
      row.occupancy_mean = report::ratio(cell.use.waiting_sum, cell.use.sent);
      row.same_digest = cell.same_digest;
    }
    return rows;
  }

 private:
  /// False if it was stopped.
  bool run(Cell& cell) {
    if (trial_.stop.stop_requested()) return false;
    const Digests digests = run_cell(prepared_, trial_.place, cell, trial_.stop);
    if (trial_.stop.stop_requested()) return false;
    if (!expected_) expected_ = digests;
    cell.same_digest &= digests == *expected_;
    if (trial_.progress)
      trial_.progress(++done_ / static_cast<double>(cells_.size() * trial_.repetitions + 2 * paired_));
    return true;
  }

  static report::StressPairs pairs_section(const Cell& fast, const Cell& slow,
                                           const ringbus::stress::PairedDifference& difference) {
    report::StressPairs out;
    out.first = {std::string(enum_name(fast.kind)), static_cast<std::uint64_t>(fast.depth)};
    out.second = {std::string(enum_name(slow.kind)), static_cast<std::uint64_t>(slow.depth)};
    out.pairs = difference.pairs;
    out.wins = difference.wins;
    out.ratio = difference.ratio;
    if (difference.pairs >= ringbus::stress::PairedDifference::kLeastPairs) {
      out.ratio_least = difference.least;
      out.ratio_most = difference.most;
    }
    out.difference = difference.first_is_faster || difference.second_is_faster;
    return out;
  }

  const Prepared& prepared_;
  const RingTrial& trial_;
  std::vector<Cell> cells_;
  std::size_t paired_ = 0;
  std::optional<Digests> expected_;
  double done_ = 0;
};

}  // namespace

std::span<const RingPlace> ring_places() {
  return kRingPlaces;
}

RingTrialResult try_in_ring(const Prepared& p, const RingTrial& trial) {
  RingCells cells(p, trial);
  cells.repeat_all();
  RingTrialResult out;
  out.pairs = cells.compare_best_and_worst();
  out.rows = cells.rows();
  return out;
}

std::string ring_verdict(const report::StressPairs& p) {
  const auto named = [](const report::StressRingChoice& choice) {
    return fmt::format("{} of depth {}", choice.queue, choice.depth);
  };
  const auto gain = [](double ratio) { return fmt::format("{:+.1f} %", 100 * (ratio - 1)); };
  const std::string first = named(p.first), second = named(p.second);
  std::string text = p.difference ? fmt::format("{} is {} than {}", first, p.ratio > 1 ? "faster" : "slower", second)
                                  : fmt::format("no difference shown between {} and {}", first, second);
  text += fmt::format(": {} traced more rays a second in {} of {} pairs of runs, median {}",
                      p.difference ? "it" : "the first", p.wins, p.pairs, gain(p.ratio));
  if (!p.ratio_least)
    return text + fmt::format("; fewer than {} pairs show nothing", ringbus::stress::PairedDifference::kLeastPairs);
  return text + fmt::format(", 99 % interval {} to {}", gain(*p.ratio_least), gain(*p.ratio_most));
}

}  // namespace carousel::app
