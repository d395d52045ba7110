// Trace event format: N. Duca, D. Sinclair, Trace Event Format, Google (2016); complete events X, counters C, metadata
// M, and flows s, t, f, whose ends are bound to the slices that enclose them.
#include "app/run/trace_events.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>
#include <unordered_map>
#include <vector>

#include <fmt/format.h>

#include "core/system/error.h"

namespace carousel::app {

namespace {

using ringbus::Slice;
using ringbus::SliceKind;

constexpr std::string_view kWindowFormat = "expected A:B with A below B, in cycles of the run (native: in seconds)";

double number(std::string_view text) {
  double value = -1;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() ? value : -1;
}

ringbus::TimelineOptions options_of(const TraceArguments& arguments, bool native) {
  ringbus::TimelineOptions out;
  out.every = arguments.every;
  out.most = arguments.events;
  if (arguments.window.empty()) return out;
  const std::size_t colon = arguments.window.find(':');
  const std::string_view window = arguments.window;
  const double scale = native ? 1e9 : 1;
  const double first = colon == std::string::npos ? -1 : number(window.substr(0, colon)) * scale,
               end = colon == std::string::npos ? -1 : number(window.substr(colon + 1)) * scale;
  const bool whole = native || (first == std::floor(first) && end == std::floor(end));
  if (first < 0 || end <= first || end > 0x1p53 || !whole)
    throw ConfigError({{{}, "--trace-window", fmt::format("found {}; {}", arguments.window, kWindowFormat)}});
  out.first = static_cast<std::uint64_t>(first);
  out.end = static_cast<std::uint64_t>(end);
  return out;
}

std::string_view name_of(SliceKind kind) {
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

/// Ends of a trip, and whether it has begun.
struct Trip {
  std::size_t slices = 0, seen = 0;
};

class Writer {
 public:
  Writer(AtomicFile& file, const ringbus::Timeline& timeline, bool native)
      : file_(file), timeline_(timeline), native_(native) {
    file_.write("{\"displayTimeUnit\":\"ns\",\"otherData\":{\"time\":\"");
    file_.write(native ? "time of the host since the start" : "1 us stands for 1 cycle");
    file_.write("\"},\"traceEvents\":[\n");
  }

  void name_tracks(const std::vector<bool>& used, bool counters) {
    if (counters) process(1, "machine");
    std::string part;
    std::uint32_t pid = 1;
    for (std::uint32_t t = 0; t < timeline_.tracks.size(); ++t) {
      const ringbus::SliceTrack& track = timeline_.tracks[t];
      if (track.part != part) {
        part = track.part;
        part_pids_[part] = ++pid;
        named_ = false;
      }
      pids_.push_back(pid);
      if (!used[t]) continue;
      if (!named_) process(pid, part);
      named_ = true;
      metadata("thread_name", pid, t + 1, fmt::format("\"name\":\"{}\"", track.name));
      metadata("thread_sort_index", pid, t + 1, fmt::format("\"sort_index\":{}", t + 1));
    }
  }

  void counter(const std::string& part, const std::string& name, double at, double value) {
    const auto found = part_pids_.find(part);
    event(fmt::format("{{\"ph\":\"C\",\"pid\":{},\"tid\":0,\"ts\":{},\"name\":\"{}\",\"args\":{{\"value\":{}}}}}",
                      found == part_pids_.end() ? 1 : found->second, time(at), name, value));
  }

  void slice(const Slice& s) {
    std::string packet;
    if (s.kind != SliceKind::kUnits) packet = fmt::format(",\"args\":{{\"packet\":{},\"rays\":{}}}", s.packet, s.rays);
    event(fmt::format("{{\"ph\":\"X\",\"pid\":{},\"tid\":{},\"ts\":{},\"dur\":{},\"cat\":\"{}\",\"name\":\"{}\"{}}}",
                      pids_[s.track], s.track + 1, time(static_cast<double>(s.begin)),
                      time(static_cast<double>(s.end - s.begin)), s.kind == SliceKind::kUnits ? "units" : "packets",
                      name_of(s.kind), packet));
  }

  /// A point of a packet's way, within the slice. `phase`: s, t or f.
  void flow(const Slice& s, char phase) {
    event(
        fmt::format("{{\"ph\":\"{}\",\"pid\":{},\"tid\":{},\"ts\":{},\"cat\":\"packets\",\"name\":\"way of a "
                    "packet\",\"id\":{}{}}}",
                    phase, pids_[s.track], s.track + 1, time(static_cast<double>(s.begin)), s.trip,
                    phase == 'f' ? ",\"bp\":\"e\"" : ""));
  }

  std::size_t finish() {
    file_.write("\n]}\n");
    file_.commit();
    return events_;
  }

 private:
  std::string time(double at) const { return native_ ? fmt::format("{:.3f}", at * 1e-3) : fmt::format("{:.0f}", at); }
  void process(std::uint32_t pid, const std::string& name) {
    metadata("process_name", pid, 0, fmt::format("\"name\":\"{}\"", name));
    metadata("process_sort_index", pid, 0, fmt::format("\"sort_index\":{}", pid));
  }
  void metadata(std::string_view kind, std::uint32_t pid, std::uint32_t tid, const std::string& arguments) {
    event(fmt::format("{{\"ph\":\"M\",\"pid\":{},\"tid\":{},\"ts\":0,\"name\":\"{}\",\"args\":{{{}}}}}", pid, tid, kind,
                      arguments));
  }
  void event(const std::string& text) {
    if (events_++ > 0) file_.write(",\n");
    file_.write(text);
  }

  AtomicFile& file_;
  const ringbus::Timeline& timeline_;
  bool native_, named_ = false;
  std::size_t events_ = 0;
  std::vector<std::uint32_t> pids_;  // by track
  std::unordered_map<std::string, std::uint32_t> part_pids_;
};

/// Occupancies: levels of rays, packets and entries.
bool is_counter(const ringbus::SeriesRow& row) {
  return row.kind == ringbus::SeriesRow::Kind::kMean && row.unit != "share";
}

}  // namespace

TraceFile::TraceFile(const TraceArguments& arguments, bool native)
    : name_(arguments.file),
      file_(arguments.file),
      wanted_(options_of(arguments, native)),
      most_(arguments.events),
      native_(native) {}

ringbus::TimelineOptions TraceFile::wanted() const {
  return wanted_;
}

TraceFile::Written TraceFile::write(const ringbus::Timeline& timeline, const ringbus::TimeSeries* series) {
  Written out{0, timeline.cut};
  // Names and counters, which say most, go first; the rest is left to slices, each with its point of a flow.
  const double scale = native_ ? 1e9 : 1;
  std::vector<std::pair<const ringbus::SeriesRow*, std::size_t>> counters;
  if (series != nullptr)
    for (const ringbus::SeriesRow& row : series->rows)
      for (std::size_t i = 0; is_counter(row) && i < row.values.size(); ++i) {
        const double at = static_cast<double>(i) * series->interval * scale;
        if (at < static_cast<double>(wanted_.first) || at >= static_cast<double>(std::min(wanted_.end, timeline.end)))
          continue;
        if (counters.size() < most_ / 4 || row.part == "machine") counters.emplace_back(&row, i);
      }
  if (counters.size() > most_ / 4) counters.resize(most_ / 4);
  const std::size_t names = 4 * timeline.tracks.size() + 2;
  std::size_t budget = most_ - std::min(most_, names + counters.size());
  std::size_t slices = 0;
  for (; slices < timeline.slices.size(); ++slices) {
    const std::size_t needed = timeline.slices[slices].trip != 0 ? 2 : 1;
    if (needed > budget) break;
    budget -= needed;
  }
  out.cut |= slices < timeline.slices.size();
  std::unordered_map<std::uint64_t, Trip> trips;
  std::vector<bool> used(timeline.tracks.size());
  for (std::size_t i = 0; i < slices; ++i) {
    const Slice& slice = timeline.slices[i];
    used[slice.track] = true;
    if (slice.trip != 0) ++trips[slice.trip].slices;
  }
  Writer writer(file_, timeline, native_);
  writer.name_tracks(used, !counters.empty());
  for (const auto& [row, i] : counters)
    writer.counter(row->part, row->quantity, static_cast<double>(i) * series->interval * scale, row->values[i]);
  for (std::size_t i = 0; i < slices; ++i) {
    const Slice& slice = timeline.slices[i];
    writer.slice(slice);
    if (slice.trip == 0) continue;
    Trip& trip = trips[slice.trip];
    if (trip.slices < 2) continue;
    ++trip.seen;
    writer.flow(slice, trip.seen == 1 ? 's' : trip.seen == trip.slices ? 'f' : 't');
  }
  out.events = writer.finish();
  return out;
}

}  // namespace carousel::app
