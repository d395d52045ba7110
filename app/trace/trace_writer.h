#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

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
  /// The tracks that have slices, by index; `counters`: there will be some. One of about `every` packets is there.
  virtual void name_tracks(const std::vector<bool>& used, bool counters, std::uint64_t every) = 0;
  virtual void counter(const std::string& part, const std::string& name, double at, double value) = 0;
  virtual void slice(const ringbus::Slice& slice, OnWay way) = 0;
  /// Ends the events. Returns the events in it.
  virtual std::size_t finish() = 0;
};

/// Marks the trace of a run that was interrupted.
inline constexpr const char* kIncomplete = "incomplete: the run was interrupted";

/// Marks a trace that has one of about `every` packets; empty if it has all.
inline std::string sample_text(std::uint64_t every) {
  return every == 1 ? "" : fmt::format("one of about {} packets, and no units, for there were too many events", every);
}

/// Numbers that tell more of a slice, with their names.
struct SliceArguments {
  const char* first = nullptr;  ///< the name of Slice::packet; null: there are none
  const char* second = nullptr;
};

inline SliceArguments arguments_of(ringbus::SliceKind kind) {
  using ringbus::SliceKind;
  if (kind == SliceKind::kUnits) return {};
  if (kind == SliceKind::kSend || kind == SliceKind::kReceive) return {"message", "packets"};
  return {"packet", "rays"};
}

inline std::string_view category_of(ringbus::SliceKind kind) {
  using ringbus::SliceKind;
  if (kind == SliceKind::kUnits) return "units";
  return kind == SliceKind::kSend || kind == SliceKind::kReceive ? "messages" : "packets";
}

/// Says what the times of a rank are worth; empty for a part that is none.
inline std::string clock_text(const ringbus::Timeline& timeline, std::string_view part) {
  for (std::size_t rank = 0; rank < timeline.clocks.size(); ++rank) {
    if (part != fmt::format("rank {}", rank)) continue;
    const double uncertainty = static_cast<double>(timeline.clocks[rank].uncertainty) * 1e-3;
    return uncertainty > 0 ? fmt::format("clock within {:.3f} us of that of rank 0", uncertainty) : "clock of rank 0";
  }
  return {};
}

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
    case SliceKind::kSend:
      return "send";
    case SliceKind::kReceive:
      return "receive";
    case SliceKind::kUnits:
      break;
  }
  return "busy";
}

}  // namespace carousel::app
