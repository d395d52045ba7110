#include "ringbus/verdict/phases.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/numeric/worth_naming.h"
#include "ringbus/verdict/progress_blocks.h"

namespace carousel::ringbus {

namespace {

constexpr std::size_t kBlocks = 16;

/// The time that a run took for each block of completed rays.
std::vector<double> block_times(const PilotRun& run) {
  std::vector<double> out;
  double before = 0;
  for (std::size_t b = 1; b <= kBlocks; ++b) {
    const double at = b == kBlocks ? static_cast<double>(run.result->cycles)
                                   : at_count(*run.result, run.rays * b / kBlocks, cycle_of);
    out.push_back(at - before);
    before = at;
  }
  return out;
}

/// The standard deviation of a block by chance, from the differences between neighbours.
double deviation_of(const std::vector<double>& values) {
  double squares = 0;
  for (std::size_t i = 1; i < values.size(); ++i)
    squares += (values[i] - values[i - 1]) * (values[i] - values[i - 1]) / 2;
  return std::sqrt(squares / static_cast<double>(values.size() - 1));
}

/// The row to take in each column, such that the sum of what stands there, less `price` for each change of row, is
/// greatest.
std::vector<std::size_t> best_rows(const std::vector<std::vector<double>>& worth, double price) {
  const std::size_t columns = worth.front().size();
  std::vector<double> sum(worth.size(), 0);
  std::vector<std::vector<std::size_t>> from(columns, std::vector<std::size_t>(worth.size()));
  for (std::size_t column = 0; column < columns; ++column) {
    const auto best = static_cast<std::size_t>(std::max_element(sum.begin(), sum.end()) - sum.begin());
    const std::vector<double> before = sum;
    for (std::size_t row = 0; row < worth.size(); ++row) {
      const bool change = column > 0 && before[best] - price > before[row];
      from[column][row] = change ? best : row;
      sum[row] = (change ? before[best] - price : before[row]) + worth[row][column];
    }
  }
  std::vector<std::size_t> out(columns);
  std::size_t row = static_cast<std::size_t>(std::max_element(sum.begin(), sum.end()) - sum.begin());
  for (std::size_t column = columns; column-- > 0; row = from[column][row]) out[column] = row;
  return out;
}

}  // namespace

std::vector<FramePhase> frame_phases(const PilotRun& base, const std::vector<PilotRun>& relaxed) {
  if (relaxed.empty() || base.rays < kBlocks) return {};
  const std::vector<double> times = block_times(base);
  const double all = static_cast<double>(base.result->cycles);
  std::vector<std::vector<double>> others, saved;
  double noise = 0;
  for (const PilotRun& run : relaxed) {
    others.push_back(block_times(run));
    std::vector<double>& row = saved.emplace_back();
    for (std::size_t b = 0; b < kBlocks; ++b) row.push_back(times[b] - others.back()[b]);
    noise = std::max(noise, deviation_of(row));
  }
  // A row for no class: it saves what a class must save to be worth a verdict.
  std::vector<double>& none = saved.emplace_back();
  for (const double time : times) none.push_back(time * kWorthIt / (1 + kWorthIt));
  const std::vector<std::size_t> rows = best_rows(saved, std::max(3 * noise, 0.02 * all));
  std::vector<FramePhase> out;
  for (std::size_t first = 0, end = 0; first < kBlocks; first = end) {
    while (end < kBlocks && rows[end] == rows[first]) ++end;
    const auto sum = [&](const std::vector<double>& values) {
      return std::accumulate(values.begin() + static_cast<std::ptrdiff_t>(first),
                             values.begin() + static_cast<std::ptrdiff_t>(end), 0.0);
    };
    FramePhase& phase = out.emplace_back();
    phase.begin = static_cast<double>(first) / kBlocks;
    phase.end = static_cast<double>(end) / kBlocks;
    phase.time = sum(times) / all;
    phase.best = rows[first] < relaxed.size() ? rows[first] : kNoClass;
    if (phase.best != kNoClass) phase.gain = sum(times) / std::max(1.0, sum(others[phase.best])) - 1;
  }
  return out;
}

std::vector<GainPhase> gain_phases(const RunResult& base, const std::vector<WhatIf>& what_ifs,
                                   const std::map<std::size_t, RunResult>& relaxed) {
  std::vector<std::size_t> classes;
  std::vector<PilotRun> runs;
  for (const auto& [i, run] : relaxed) {
    classes.push_back(i);
    runs.push_back({&*run.cycle, run.rays_completed});
  }
  std::vector<GainPhase> out;
  for (const FramePhase& phase : frame_phases({&*base.cycle, base.rays_completed}, runs)) {
    GainPhase& one = out.emplace_back(GainPhase{phase.begin, phase.end, phase.time, "", "", phase.gain});
    if (phase.best == kNoClass) continue;
    one.name = what_ifs[classes[phase.best]].name();
    one.action = what_ifs[classes[phase.best]].part.action;
  }
  return out;
}

}  // namespace carousel::ringbus
