#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <unordered_set>

#include "core/config/parts/stride_prefetcher.h"
#include "core/types/prefetcher_offer.h"
#include "ringbus/cycle/parts/attached_part.h"
#include "ringbus/cycle/parts/stride_prefetcher/prefetcher_ports.h"

namespace carousel::ringbus::cycle {

/// A prefetcher whose rule a plugin brings. Wires, counts and the bound on requests are those of the machine. A rule
/// that breaks its contract ends the run with a SimulationError.
class OwnPrefetcher final : public CountingAgent<StridePrefetcherCounts>, private LinesAhead {
 public:
  /// `keys.rule` is a plugin's.
  OwnPrefetcher(const StridePrefetcherKeys& keys, PrefetcherPorts ports);

  Cycle next() const override;
  bool polled() const override { return false; }
  void run(Cycle end) override;
  std::string describe() const override { return ""; }
  const StridePrefetcherCounts& counts() const override { return counts_; }

 private:
  void ask(std::uint64_t line) override;
  void begin_call() { asked_now_ = 0; }
  [[noreturn]] void fail(const std::string& what) const;

  StridePrefetcherKeys keys_;
  PrefetcherPorts ports_;
  std::unique_ptr<Prefetcher> rule_;
  Cycle now_ = 0;
  std::int64_t asked_now_ = 0;               // lines, in the call that runs
  std::unordered_set<std::uint64_t> asked_;  // lines of which no hint has come since
  StridePrefetcherCounts counts_;
};

}  // namespace carousel::ringbus::cycle
