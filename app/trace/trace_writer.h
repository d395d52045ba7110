#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "ringbus/results/slice_log.h"

namespace carousel::app {

/// The place of a slice on a packet's way.
enum class OnWay { kNone, kFirst, kThrough, kLast };

/// Writes events in one format. Called in the order of the functions below, by one thread. Times are cycles, or
/// nanoseconds of the host.
class TraceWriter {
 public:
  virtual ~TraceWriter() = default;

  /// Events that a slice takes, at most.
  virtual std::size_t events_of(const ringbus::Slice& slice) const = 0;
  /// The tracks that have slices, by index; `counters`: there will be some.
  virtual void name_tracks(const std::vector<bool>& used, bool counters) = 0;
  virtual void counter(const std::string& part, const std::string& name, double at, double value) = 0;
  virtual void slice(const ringbus::Slice& slice, OnWay way) = 0;
  /// Completes the file. Returns the events in it.
  virtual std::size_t finish() = 0;
};

inline std::string_view name_of(ringbus::SliceKind kind) {
  using ringbus::SliceKind;
  switch (kind) {
    case SliceKind::kIssue:
      return "issue";
    case SliceKind::kVisit:
      return "visit";
    case SliceKind::kPass:
      return "pass";
    case SliceKind::kRetire:
      return "retire";
    case SliceKind::kTest:
      return "test";
    case SliceKind::kLink:
      return "packet";
    case SliceKind::kUnits:
      break;
  }
  return "busy";
}

}  // namespace carousel::app
