#include "app/sweep/sampled_sweep.h"

#include "app/sweep/analysis.h"

namespace carousel::app {

namespace {

/// The place of the fraction among the keys of a point that was sampled; null for a whole one.
KeyValue* sampled_key(Choice& keys) {
  for (KeyValue& key : keys)
    if (key.first == kSampledKey && key.second != "1") return &key;
  return nullptr;
}

}  // namespace

void run_front_whole(const SweepSetup& setup, const SweepOptions& options, PointMaker& maker, const std::string& goals,
                     SweepRows& rows, Ledger* ledger, const InterruptScope& interrupt) {
  while (!interrupt.interrupted()) {
    SweepRows whole{rows.keys, rows.columns, {}};
    std::vector<std::size_t> which;
    for (const std::size_t i : pareto_front(rows, parse_goals(rows, goals))) {
      Choice keys = rows.rows[i].point.keys;
      KeyValue* key = sampled_key(keys);
      if (key == nullptr) continue;
      key->second = "1";
      which.push_back(i);
      whole.rows.push_back({maker.make(keys), false, {}, 0, {}});
    }
    if (which.empty()) return;
    read_finished(setup, whole, options.retry_failed);
    run_missing(setup, options, whole, ledger, interrupt);
    for (std::size_t i = 0; i < which.size(); ++i)
      if (whole.rows[i].finished) rows.rows[which[i]] = std::move(whole.rows[i]);
  }
}

}  // namespace carousel::app
