// Trace event format: N. Duca, D. Sinclair, Trace Event Format, Google (2016); complete events X, counters C, metadata
// M, and flows s, t, f, whose ends are bound to the slices that enclose them.
#include "app/trace/chrome_trace.h"

#include <cstdint>
#include <unordered_map>

#include <fmt/format.h>

namespace carousel::app {

namespace {

using ringbus::Slice;

class ChromeTrace final : public TraceWriter {
 public:
  ChromeTrace(AtomicFile& file, const ringbus::Timeline& timeline, bool native, bool complete)
      : file_(file), timeline_(timeline), native_(native) {
    file_.write("{\"displayTimeUnit\":\"ns\",\"otherData\":{\"time\":\"");
    file_.write(!native                   ? "1 us stands for 1 cycle"
                : timeline.clocks.empty() ? "time of the host since the start"
                                          : "time of the host of rank 0 since the start");
    file_.write("\"");
    if (!complete) file_.write(fmt::format(",\"incomplete\":\"{}\"", kIncomplete));
    write_clocks();
  }

  std::size_t events_of(const Slice& s) const override { return s.trip != 0 ? 2 : 1; }

  void name_tracks(const std::vector<bool>& used, bool counters, std::uint64_t every) override {
    if (every > 1) file_.write(fmt::format(",\"sample\":\"{}\"", sample_text(every)));
    file_.write("},\"traceEvents\":[\n");
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

  void counter(const std::string& part, const std::string& name, double at, double value) override {
    const auto found = part_pids_.find(part);
    event(fmt::format("{{\"ph\":\"C\",\"pid\":{},\"tid\":0,\"ts\":{},\"name\":\"{}\",\"args\":{{\"value\":{}}}}}",
                      found == part_pids_.end() ? 1 : found->second, time(at), name, value));
  }

  void slice(const Slice& s, OnWay way) override {
    std::string packet;
    if (const SliceArguments names = arguments_of(s.kind); names.first != nullptr)
      packet = fmt::format(",\"args\":{{\"{}\":{},\"{}\":{}}}", names.first, s.packet, names.second, s.rays);
    event(fmt::format("{{\"ph\":\"X\",\"pid\":{},\"tid\":{},\"ts\":{},\"dur\":{},\"cat\":\"{}\",\"name\":\"{}\"{}}}",
                      pids_[s.track], s.track + 1, time(static_cast<double>(s.begin)),
                      time(static_cast<double>(s.end - s.begin)), category_of(s.kind), name_of(s.kind), packet));
    if (way == OnWay::kNone) return;
    const char phase = way == OnWay::kFirst ? 's' : way == OnWay::kLast ? 'f' : 't';
    event(
        fmt::format("{{\"ph\":\"{}\",\"pid\":{},\"tid\":{},\"ts\":{},\"cat\":\"{}\",\"name\":\"way of a "
                    "{}\",\"id\":{}{}}}",
                    phase, pids_[s.track], s.track + 1, time(static_cast<double>(s.begin)), category_of(s.kind),
                    arguments_of(s.kind).first, s.trip, phase == 'f' ? ",\"bp\":\"e\"" : ""));
  }

  std::size_t finish() override {
    file_.write("\n]}\n");
    return events_;
  }

 private:
  /// With ranks: how far each clock was ahead of rank 0's when the run began, which the times have been freed of, and
  /// by how much this may be wrong.
  void write_clocks() {
    if (timeline_.clocks.empty()) return;
    file_.write(",\"clocks\":[");
    for (std::size_t rank = 0; rank < timeline_.clocks.size(); ++rank) {
      const ringbus::RankClock& clock = timeline_.clocks[rank];
      file_.write(fmt::format("{}{{\"rank\":{},\"ahead_us\":{:.3f},\"uncertainty_us\":{:.3f}}}", rank > 0 ? "," : "",
                              rank, static_cast<double>(clock.ahead) * 1e-3,
                              static_cast<double>(clock.uncertainty) * 1e-3));
    }
    file_.write("]");
  }
  std::string time(double at) const { return native_ ? fmt::format("{:.3f}", at * 1e-3) : fmt::format("{:.0f}", at); }
  void process(std::uint32_t pid, const std::string& name) {
    metadata("process_name", pid, 0, fmt::format("\"name\":\"{}\"", name));
    metadata("process_sort_index", pid, 0, fmt::format("\"sort_index\":{}", pid));
    const std::string clock = clock_text(timeline_, name);
    if (!clock.empty()) metadata("process_labels", pid, 0, fmt::format("\"labels\":\"{}\"", clock));
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

}  // namespace

std::unique_ptr<TraceWriter> chrome_trace(AtomicFile& file, const ringbus::Timeline& timeline, bool native,
                                          bool complete) {
  return std::make_unique<ChromeTrace>(file, timeline, native, complete);
}

}  // namespace carousel::app
