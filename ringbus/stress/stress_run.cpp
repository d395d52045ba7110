#include "ringbus/stress/stress_run.h"

#include <algorithm>

namespace carousel::ringbus::stress {

namespace {

double quantile(std::vector<double> values, double q) {
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  const double at = q * static_cast<double>(values.size() - 1);
  const std::size_t low = static_cast<std::size_t>(at), high = std::min(low + 1, values.size() - 1);
  return values[low] + (values[high] - values[low]) * (at - static_cast<double>(low));
}

void add(TrialResult& sum, const TrialResult& one, bool first) {
  sum.threads = one.threads;
  sum.messages += one.messages;
  sum.seconds += one.seconds;
  sum.transit_ns.add(one.transit_ns);
  sum.round_trip_ns.add(one.round_trip_ns);
  sum.push_calls += one.push_calls;
  sum.push_refusals += one.push_refusals;
  sum.pop_calls += one.pop_calls;
  sum.pop_refusals += one.pop_refusals;
  sum.blocked_seconds += one.blocked_seconds;
  sum.producer_seconds += one.producer_seconds;
  sum.fairness = first ? one.fairness : std::min(sum.fairness, one.fairness);
  sum.memory_bytes = std::max(sum.memory_bytes, one.memory_bytes);
  sum.violations += one.violations;
}

std::vector<std::size_t> sizes_for(Pattern pattern, const StressOptions& options) {
  if (!options.message_bytes.empty()) return options.message_bytes;
  if (pattern == Pattern::kStream || pattern == Pattern::kBatches) return {kSmall, kLine, kPacket};
  return {kLine};
}

}  // namespace

double StressRow::median() const {
  return quantile(rates, 0.5);
}
double StressRow::least() const {
  return quantile(rates, 0);
}
double StressRow::most() const {
  return quantile(rates, 1);
}

std::vector<StressRow> run_stress(std::span<const QueueUnderTest> queues, const StressOptions& options) {
  std::vector<Pattern> patterns = options.patterns;
  if (patterns.empty())
    for (const PatternName& entry : kPatterns) patterns.push_back(entry.pattern);

  std::vector<StressRow> rows;
  struct Group {
    std::size_t first, count;  // the rows of one pattern and size
  };
  std::vector<Group> groups;
  for (const Pattern pattern : patterns)
    for (const std::size_t bytes : sizes_for(pattern, options)) {
      groups.push_back({rows.size(), 0});
      for (std::size_t q = 0; q < queues.size(); ++q)
        if (pattern_fits(queues[q], pattern)) {
          StressRow row;
          row.queue = q;
          row.pattern = pattern;
          row.message_bytes = bytes;
          rows.push_back(std::move(row));
          ++groups.back().count;
        }
    }

  const double trials = static_cast<double>(rows.size() * options.repetitions);
  TrialOptions trial;
  trial.capacity = options.capacity;
  trial.messages = options.messages;
  trial.stuck_after = options.stuck_after;
  trial.stop = options.stop;
  trial.time = std::chrono::nanoseconds(static_cast<std::int64_t>(1e9 * options.seconds / std::max(trials, 1.0)));
  double done = 0;
  for (std::size_t repetition = 0; repetition < options.repetitions; ++repetition)
    for (const Group& group : groups)
      for (std::size_t k = 0; k < group.count; ++k) {
        if (options.stop.stop_requested()) return rows;
        StressRow& row = rows[group.first + (k + repetition) % group.count];
        trial.pattern = row.pattern;
        trial.message_bytes = row.message_bytes;
        trial.seed = options.seed + repetition;
        const TrialResult result = run_trial(queues[row.queue], trial);
        add(row.sum, result, row.rates.empty());
        row.rates.push_back(result.seconds > 0 ? static_cast<double>(result.messages) / result.seconds : 0);
        if (options.progress) options.progress(++done / trials);
      }
  return rows;
}

}  // namespace carousel::ringbus::stress
