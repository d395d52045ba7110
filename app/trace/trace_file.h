#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "app/host/extra_file.h"
#include "ringbus/results/slice_log.h"
#include "ringbus/results/time_series.h"

namespace carousel::app {

/// The parts of a run that --trace asks for.
struct TraceArguments {
  std::string file;                ///< empty: none
  std::string window;              ///< A:B in cycles, or seconds of a native run; empty: the whole run
  std::uint64_t every = 0;         ///< one of so many packets of each resource is traced; 0: as many as `events` allow
  std::size_t events = 1'000'000;  ///< most events
};

/// A file of events that ui.perfetto.dev opens: Perfetto's protobuf if its name ends in .pftrace or .perfetto-trace, or
/// Chrome's JSON, which chrome://tracing opens as well. A cycle stands for a microsecond.
class TraceFile {
 public:
  /// Throws a ConfigError for a window that is none or a format that this build does not write. `native`: times are
  /// nanoseconds of the host. `file`: null at a rank that only records, for rank 0's file.
  TraceFile(const TraceArguments& arguments, bool native, ExtraFile* file);

  const std::string& name() const { return name_; }
  /// For the engine.
  ringbus::TimelineOptions wanted() const;

  struct Written {
    std::size_t events = 0;
    std::uint64_t left = 1;   ///< one of about so many packets is left, for there were too many events
    bool cut = false;         ///< the later events were left out, for there were too many
    double reached = 1;       ///< the part of the time that was asked for to which they reach
    std::uint64_t every = 1;  ///< if they were cut: one of so many packets may reach to its end
  };
  /// Only where it writes. `series` may be null. Occupancies become counters, packets flows from part to part. The
  /// trace of a run that was interrupted (not `complete`) says so. The file keeps an error.
  Written write(const ringbus::Timeline& timeline, const ringbus::TimeSeries* series, bool complete);

 private:
  Written write_events(AtomicFile& file, const ringbus::Timeline& timeline, const ringbus::TimeSeries* series,
                       bool complete) const;

  std::string name_;
  bool perfetto_;
  ExtraFile* file_;
  ringbus::TimelineOptions wanted_;
  std::size_t most_;
  bool native_;
};

}  // namespace carousel::app
