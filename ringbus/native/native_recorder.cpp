#include "ringbus/native/native_recorder.h"

#include <algorithm>
#include <limits>
#include <tuple>

#include <fmt/format.h>

namespace carousel::ringbus {

NativeRecorder::NativeRecorder(const Config& config, std::size_t packets, const TimelineOptions& timeline,
                               FollowedRay* ray)
    : topology_(config.topology), ray_(ray), trips_(packets) {
  static_assert(std::is_same_v<Clock::period, std::nano>);
  TimelineOptions options = timeline;
  if (ray != nullptr) options = {.every = 0, .most = std::numeric_limits<std::size_t>::max()};
  const std::size_t resources = topology_.resources();
  for (std::size_t r = 0; r < resources; ++r) {
    slices_.emplace_back(options, options.most / resources + 1);
    facts_.push_back({ray_, {}});
  }
}

Recording NativeRecorder::of_resource(ResourceId id) {
  return {&slices_[id.value], &trips_, id.value, ray_ != nullptr ? &facts_[id.value] : nullptr};
}

Timeline NativeRecorder::timeline() const {
  Timeline out{{}, {}, now(), false};
  for (std::size_t r = 0; r < slices_.size(); ++r) out.tracks.push_back({fmt::format("resource {}", r), "packets"});
  for (std::size_t w = 0; w < topology_.wires().size(); ++w) {
    const Topology::Wire& wire = topology_.wires()[w];
    out.tracks.push_back({"links", fmt::format("link {}: {} to {}", w, wire.from.value, wire.to.value)});
  }
  for (const SliceLog& log : slices_) {
    out.slices.insert(out.slices.end(), log.slices().begin(), log.slices().end());
    out.cut |= log.stopped();
  }
  std::stable_sort(out.slices.begin(), out.slices.end(), [](const Slice& a, const Slice& b) {
    return std::tie(a.begin, a.track) < std::tie(b.begin, b.track);
  });
  return out;
}

std::vector<RayFact> NativeRecorder::facts() const {
  std::vector<RayFact> out;
  for (const RayLog& log : facts_) out.insert(out.end(), log.facts.begin(), log.facts.end());
  std::stable_sort(out.begin(), out.end(), [](const RayFact& a, const RayFact& b) { return a.at < b.at; });
  return out;
}

}  // namespace carousel::ringbus
