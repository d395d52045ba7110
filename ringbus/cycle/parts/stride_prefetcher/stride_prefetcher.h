#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/config/parts/stride_prefetcher.h"
#include "ringbus/cycle/parts/attached_part.h"
#include "ringbus/cycle/parts/stride_prefetcher/prefetcher_ports.h"

namespace carousel::ringbus::cycle {

/// A prefetcher along streams of equal strides (T.-F. Chen and J.-L. Baer, Effective hardware-based data prefetching
/// for high-performance processors, IEEE Transactions on Computers 44 (1995), section 3). A tester has no program
/// counter by which their table is looked up, so that a line belongs to the first stream whose last line is near it. A
/// line that follows its stream by the stream's stride makes the prefetcher ask its L2 for the next lines, each once.
class StridePrefetcher final : public CountingAgent<StridePrefetcherCounts> {
 public:
  StridePrefetcher(const StridePrefetcherKeys& keys, PrefetcherPorts ports);

  Cycle next() const override { return ports_.next(); }
  bool polled() const override { return false; }
  void run(Cycle end) override;
  std::string describe() const override { return ""; }
  const StridePrefetcherCounts& counts() const override { return counts_; }

 private:
  struct Stream {
    std::int64_t last = 0, stride = 0;  // lines
    std::int64_t asked = 0;             // lines asked for ahead of the last one, in strides
    bool begun = false;
  };

  void take(const ShapeHint& hint, Cycle now);
  void follow(Stream& stream, std::int64_t line, Cycle now);
  void ask(std::int64_t line, Cycle now);

  std::int64_t ahead_, reach_;
  PrefetcherPorts ports_;
  std::vector<Stream> streams_;
  std::size_t oldest_ = 0;  // the stream that is replaced next
  StridePrefetcherCounts counts_;
};

/// Makes the prefetchers of a machine.
std::vector<AttachedPart<StridePrefetcherCounts>> attach(const StridePrefetcherKeys& keys, const PartSites& sites);

}  // namespace carousel::ringbus::cycle
