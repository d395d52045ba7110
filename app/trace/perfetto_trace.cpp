#include "app/trace/perfetto_trace.h"

#if __has_include(<app/trace/perfetto.pb.h>)

#include <cmath>
#include <cstdint>
#include <map>
#include <utility>

#include <app/trace/perfetto.pb.h>

namespace carousel::app {

namespace {

using ringbus::Slice;

class PerfettoTrace final : public TraceWriter {
 public:
  PerfettoTrace(AtomicFile& file, const ringbus::Timeline& timeline, bool native, bool complete)
      : file_(file), timeline_(timeline), scale_(native ? 1 : 1000), complete_(complete) {}

  std::size_t events_of(const Slice&) const override { return 2; }

  void name_tracks(const std::vector<bool>& used, bool counters, std::uint64_t every) override {
    sample_ = sample_text(every);
    if (counters) name_part("machine");
    for (std::uint32_t t = 0; t < timeline_.tracks.size(); ++t) {
      if (!used[t]) continue;
      const std::uint64_t part = name_part(timeline_.tracks[t].part);
      perfetto::TrackDescriptor& track = *next().mutable_track_descriptor();
      track.set_uuid(track_uuid(t));
      track.set_parent_uuid(part);
      track.set_name(timeline_.tracks[t].name);
      track.set_sibling_order_rank(static_cast<std::int32_t>(t));
      write();
    }
  }

  void counter(const std::string& part, const std::string& name, double at, double value) override {
    const std::uint64_t parent = name_part(part);
    const auto [found, added] = counters_.try_emplace({parent, name}, kCounters + counters_.size());
    if (added) {
      perfetto::TrackDescriptor& track = *next().mutable_track_descriptor();
      track.set_uuid(found->second);
      track.set_parent_uuid(parent);
      track.set_name(name);
      track.mutable_counter();
      write();
    }
    perfetto::TrackEvent& event = event_at(at, perfetto::TrackEvent::TYPE_COUNTER, found->second);
    event.set_double_counter_value(value);
    write();
  }

  void slice(const Slice& s, OnWay way) override {
    perfetto::TrackEvent& begin =
        event_at(static_cast<double>(s.begin), perfetto::TrackEvent::TYPE_SLICE_BEGIN, track_uuid(s.track));
    const std::string_view name = name_of(s.kind);
    begin.set_name(name.data(), name.size());
    const std::string_view category = category_of(s.kind);
    begin.add_categories(category.data(), category.size());
    if (const SliceArguments names = arguments_of(s.kind); names.first != nullptr) {
      annotate(begin, names.first, static_cast<std::int64_t>(s.packet));
      annotate(begin, names.second, static_cast<std::int64_t>(s.rays));
    }
    if (way == OnWay::kLast)
      begin.add_terminating_flow_ids(s.trip);
    else if (way != OnWay::kNone)
      begin.add_flow_ids(s.trip);
    write();
    event_at(static_cast<double>(s.end), perfetto::TrackEvent::TYPE_SLICE_END, track_uuid(s.track));
    write();
  }

  std::size_t finish() override { return packets_; }

 private:
  // Tracks have numbers that are unique in the file: parts from 1, and far above them slices and counters.
  static constexpr std::uint64_t kTracks = std::uint64_t{1} << 32, kCounters = std::uint64_t{2} << 32;
  static std::uint64_t track_uuid(std::uint32_t t) { return kTracks + t; }

  /// The number of a part's track, which is written when it is first named.
  std::uint64_t name_part(const std::string& part) {
    const auto [found, added] = parts_.try_emplace(part, parts_.size() + 1);
    if (added) {
      perfetto::TrackDescriptor& track = *next().mutable_track_descriptor();
      track.set_uuid(found->second);
      track.set_child_ordering(3);
      track.mutable_process()->set_pid(static_cast<std::int32_t>(found->second));
      track.mutable_process()->set_process_name(part);
      if (std::string clock = clock_text(timeline_, part); !clock.empty())
        track.mutable_process()->add_process_labels(std::move(clock));
      if (!complete_) track.mutable_process()->add_process_labels(kIncomplete);
      if (!sample_.empty()) track.mutable_process()->add_process_labels(sample_);
      write();
    }
    return found->second;
  }

  perfetto::TracePacket& next() {
    trace_.Clear();
    perfetto::TracePacket& packet = *trace_.add_packet();
    packet.set_trusted_packet_sequence_id(1);
    return packet;
  }

  perfetto::TrackEvent& event_at(double at, perfetto::TrackEvent::Type type, std::uint64_t track) {
    perfetto::TracePacket& packet = next();
    packet.set_timestamp(static_cast<std::uint64_t>(std::llround(at * scale_)));
    packet.mutable_track_event()->set_type(type);
    packet.mutable_track_event()->set_track_uuid(track);
    return *packet.mutable_track_event();
  }

  static void annotate(perfetto::TrackEvent& event, const char* name, std::int64_t value) {
    perfetto::DebugAnnotation& annotation = *event.add_debug_annotations();
    annotation.set_name(name);
    annotation.set_int_value(value);
  }

  /// Traces of one packet each, one after the other, are a trace of all packets: protobuf joins repeated fields.
  void write() {
    file_.write(trace_.SerializeAsString());
    ++packets_;
  }

  AtomicFile& file_;
  const ringbus::Timeline& timeline_;
  double scale_;
  bool complete_;
  std::string sample_;
  perfetto::Trace trace_;
  std::size_t packets_ = 0;
  std::map<std::string, std::uint64_t> parts_;
  std::map<std::pair<std::uint64_t, std::string>, std::uint64_t> counters_;
};

}  // namespace

bool has_perfetto_trace() {
  return true;
}

std::unique_ptr<TraceWriter> perfetto_trace(AtomicFile& file, const ringbus::Timeline& timeline, bool native,
                                            bool complete) {
  return std::make_unique<PerfettoTrace>(file, timeline, native, complete);
}

}  // namespace carousel::app

#else

namespace carousel::app {

bool has_perfetto_trace() {
  return false;
}

std::unique_ptr<TraceWriter> perfetto_trace(AtomicFile&, const ringbus::Timeline&, bool, bool) {
  return nullptr;
}

}  // namespace carousel::app

#endif
