#include "ringbus/native/native_recorder.h"

#include <algorithm>
#include <cstring>
#include <limits>
#include <string>

#include <fmt/format.h>

#include "ringbus/ranks/compare_clocks.h"
#include "ringbus/ranks/gather_timeline.h"

namespace carousel::ringbus {

namespace {

// Trips of messages are beyond those of packets, and no larger than numbers that JSON carries to the last bit.
constexpr std::uint64_t kMessages = std::uint64_t{1} << 52;

std::int64_t host_time() {
  return NativeRecorder::Clock::now().time_since_epoch().count();
}

TimelineOptions options_of(const TimelineOptions& timeline, const FollowedRay* ray) {
  if (ray == nullptr) return timeline;
  return {.every = 0, .most = std::numeric_limits<std::size_t>::max()};
}

}  // namespace

NativeRecorder::NativeRecorder(const Config& config, const RankShare& share, std::size_t packets,
                               const TimelineOptions& timeline, FollowedRay* ray)
    : topology_(config.topology),
      share_(share),
      ray_(ray),
      trips_(packets),
      messages_(options_of(timeline, ray), timeline.most / topology_.resources() + 1) {
  static_assert(std::is_same_v<Clock::period, std::nano>);
  const TimelineOptions options = options_of(timeline, ray);
  const std::size_t resources = topology_.resources(), nodes = resources + topology_.hubs().size();
  for (std::size_t n = 0; n < nodes; ++n) slices_.emplace_back(options, options.most / nodes + 1);
  for (std::size_t r = 0; r < resources; ++r) facts_.push_back({ray_, {}});
}

void NativeRecorder::start(Transport* ranks) {
  start_ = Clock::now();
  if (ranks == nullptr) return;
  clocks_ = compare_clocks(*ranks, clock_identity(), host_time);
  // Rank 0 names the moment, which has passed when the others hear of it.
  const std::int64_t own = host_time();
  std::int64_t first = 0;
  const std::string named = ranks->gather({reinterpret_cast<const char*>(&own), sizeof own})[0];
  std::memcpy(&first, named.data(), sizeof first);
  start_ = Clock::time_point(Clock::duration(first + clocks_[ranks->rank()].ahead));
}

void NativeRecorder::note_message(Ends ends, SliceKind kind, std::uint64_t number, std::size_t packets,
                                  std::uint64_t begin) {
  const bool from_here = ends.from == share_.rank();
  const std::uint32_t other = from_here ? ends.to : ends.from;
  const auto wires = static_cast<std::uint32_t>(topology_.wires().size());
  messages_.add({.begin = begin,
                 .end = now(),
                 .trip = kMessages + (number * share_.ranks() + ends.to) * share_.ranks() + ends.from,
                 .track = link_track(wires) + 2 * other + (from_here ? 0 : 1),
                 .packet = static_cast<std::uint32_t>(number),
                 .rays = static_cast<std::uint32_t>(packets),
                 .kind = kind});
}

Recording NativeRecorder::of_resource(ResourceId id) {
  return {&slices_[id.value], &trips_, id.value, ray_ != nullptr ? &facts_[id.value] : nullptr};
}

Timeline NativeRecorder::timeline(Transport* ranks) const {
  Timeline out = own_timeline();
  if (ranks != nullptr) gather_timeline(*ranks, clocks_, compare_clocks(*ranks, clock_identity(), host_time), out);
  return out;
}

/// In a machine of ranks a rank is one part, of which resources, links and messages are the tracks.
Timeline NativeRecorder::own_timeline() const {
  Timeline out;
  out.end = now();
  const std::string rank = share_.alone() ? "" : fmt::format("rank {}", share_.rank());
  for (std::size_t r = 0; r < facts_.size(); ++r) {
    const std::string resource = fmt::format("resource {}", r);
    out.tracks.push_back(rank.empty() ? SliceTrack{resource, "packets"} : SliceTrack{rank, resource});
  }
  for (std::size_t w = 0; w < topology_.wires().size(); ++w) {
    const Topology::Wire& wire = topology_.wires()[w];
    out.tracks.push_back(
        {rank.empty() ? "links" : rank, fmt::format("link {}: {} to {}", w, wire.from.value, wire.to.value)});
  }
  for (std::uint32_t r = 0; !rank.empty() && r < share_.ranks(); ++r) {
    out.tracks.push_back({rank, fmt::format("messages to rank {}", r)});
    out.tracks.push_back({rank, fmt::format("messages from rank {}", r)});
  }
  const auto take = [&](const SliceLog& log) {
    out.slices.insert(out.slices.end(), log.slices().begin(), log.slices().end());
    out.cut |= log.stopped();
    out.every = std::max(out.every, log.left());
  };
  for (const SliceLog& log : slices_) take(log);
  take(messages_);
  thin(out.slices, out.every);
  sort_slices(out.slices);
  return out;
}

std::vector<RayFact> NativeRecorder::facts() const {
  std::vector<RayFact> out;
  for (const RayLog& log : facts_) out.insert(out.end(), log.facts.begin(), log.facts.end());
  std::stable_sort(out.begin(), out.end(), [](const RayFact& a, const RayFact& b) { return a.at < b.at; });
  return out;
}

}  // namespace carousel::ringbus
