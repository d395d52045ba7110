#include "app/trace/trace_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <memory>
#include <string_view>
#include <unordered_map>
#include <vector>

#include <fmt/format.h>

#include "app/trace/chrome_trace.h"
#include "app/trace/perfetto_trace.h"
#include "core/system/error.h"

namespace carousel::app {

namespace {

using ringbus::Slice;

constexpr std::string_view kWindowFormat = "expected A:B with A below B, in cycles of the run (native: in seconds)";

double window_end(std::string_view text) {
  double value = -1;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() ? value : -1;
}

ringbus::TimelineOptions options_of(const TraceArguments& arguments, bool native) {
  ringbus::TimelineOptions out;
  out.thins = arguments.every == 0;
  out.every = std::max<std::uint64_t>(1, arguments.every);
  out.most = arguments.events;
  if (arguments.window.empty()) return out;
  const std::size_t colon = arguments.window.find(':');
  const std::string_view window = arguments.window;
  const double scale = native ? 1e9 : 1;
  const double first = colon == std::string::npos ? -1 : window_end(window.substr(0, colon)) * scale,
               end = colon == std::string::npos ? -1 : window_end(window.substr(colon + 1)) * scale;
  const bool whole = native || (first == std::floor(first) && end == std::floor(end));
  if (first < 0 || end <= first || end > 0x1p53 || !whole)
    throw ConfigError("--trace-window", fmt::format("found {}; {}", arguments.window, kWindowFormat));
  out.first = static_cast<std::uint64_t>(first);
  out.end = static_cast<std::uint64_t>(end);
  return out;
}

/// Ends of a trip, and whether it has begun.
struct Trip {
  std::size_t slices = 0, seen = 0;
};

/// Occupancies: levels of rays, packets and entries.
bool is_counter(const ringbus::SeriesRow& row) {
  return row.kind == ringbus::SeriesRow::Kind::kMean && row.unit != "share";
}

/// By the end of the name. Throws ConfigError if this build cannot write it.
bool is_perfetto(const std::string& file) {
  const bool perfetto = file.ends_with(".pftrace") || file.ends_with(".perfetto-trace");
  if (perfetto && !has_perfetto_trace())
    throw ConfigError("--trace", fmt::format("found {}, but this program was built without protobuf; expected a name "
                                             "that ends in .json",
                                             file));
  return perfetto;
}

}  // namespace

TraceFile::TraceFile(const TraceArguments& arguments, bool native, ExtraFile* file)
    : name_(arguments.file),
      perfetto_(is_perfetto(arguments.file)),
      file_(file),
      wanted_(options_of(arguments, native)),
      most_(arguments.events),
      native_(native) {}

ringbus::TimelineOptions TraceFile::wanted() const {
  return wanted_;
}

TraceFile::Written TraceFile::write(const ringbus::Timeline& timeline, const ringbus::TimeSeries* series,
                                    bool complete) {
  Written out;
  file_->write([&](AtomicFile& file) { out = write_events(file, timeline, series, complete); });
  return out;
}

TraceFile::Written TraceFile::write_events(AtomicFile& file, const ringbus::Timeline& timeline,
                                           const ringbus::TimeSeries* series, bool complete) const {
  Written out;
  out.cut = timeline.cut;
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
  const std::unique_ptr<TraceWriter> writer =
      perfetto_ ? perfetto_trace(file, timeline, native_, complete) : chrome_trace(file, timeline, native_, complete);
  const std::size_t names = 5 * timeline.tracks.size() + 2;
  std::size_t budget = most_ - std::min(most_, names + counters.size());
  out.left = timeline.every;
  const auto too_many = [&] {
    std::size_t needed = 0;
    for (const Slice& slice : timeline.slices)
      if (is_left(slice, out.left)) needed += writer->events_of(slice);
    return needed > budget;
  };
  constexpr std::uint64_t kFewest = std::uint64_t{1} << 32;
  while (wanted_.thins && out.left < kFewest && too_many()) out.left *= 2;
  std::vector<Slice> left;
  if (out.left != timeline.every)
    std::copy_if(timeline.slices.begin(), timeline.slices.end(), std::back_inserter(left),
                 [&](const Slice& slice) { return is_left(slice, out.left); });
  const std::vector<Slice>& all = out.left != timeline.every ? left : timeline.slices;
  std::size_t slices = 0;
  for (; slices < all.size(); ++slices) {
    const std::size_t needed = writer->events_of(all[slices]);
    if (needed > budget) break;
    budget -= needed;
  }
  out.cut |= slices < all.size();
  if (out.cut) {
    const double end = static_cast<double>(std::min(wanted_.end, timeline.end)),
                 first = static_cast<double>(wanted_.first);
    const double at = slices == 0 ? first : static_cast<double>(all[slices - 1].begin);
    out.reached = end > first ? std::clamp((at - first) / (end - first), 0.0, 1.0) : 1;
    // Packets are issued at no even rate, so that this is a guess with some room.
    constexpr double kRoom = 2;
    out.every =
        static_cast<std::uint64_t>(std::ceil(kRoom * static_cast<double>(wanted_.every) / std::max(out.reached, 1e-6)));
  }
  std::unordered_map<std::uint64_t, Trip> trips;
  std::vector<bool> used(timeline.tracks.size());
  for (std::size_t i = 0; i < slices; ++i) {
    const Slice& slice = all[i];
    used[slice.track] = true;
    if (slice.trip != 0) ++trips[slice.trip].slices;
  }
  writer->name_tracks(used, !counters.empty(), out.left);
  for (const auto& [row, i] : counters)
    writer->counter(row->part, row->quantity, static_cast<double>(i) * series->interval * scale, row->values[i]);
  for (std::size_t i = 0; i < slices; ++i) {
    const Slice& slice = all[i];
    OnWay way = OnWay::kNone;
    if (slice.trip != 0 && trips[slice.trip].slices >= 2) {
      Trip& trip = trips[slice.trip];
      ++trip.seen;
      way = trip.seen == 1 ? OnWay::kFirst : trip.seen == trip.slices ? OnWay::kLast : OnWay::kThrough;
    }
    writer->slice(slice, way);
  }
  out.events = writer->finish();
  return out;
}

}  // namespace carousel::app
