#include "ringbus/cycle/wiring/recorder.h"

#include <algorithm>
#include <limits>
#include <tuple>

#include <fmt/format.h>

#include "core/types/unit_kind.h"

namespace carousel::ringbus::cycle {

namespace {

TimelineOptions slices_wanted(const Observation& observed) {
  TimelineOptions options = observed.timeline;
  // Only the trips of the ray, however many.
  if (observed.ray != nullptr) options = {.every = 0, .most = std::numeric_limits<std::size_t>::max()};
  return options;
}

}  // namespace

Recorder::Recorder(const TestersConfig& testers, std::int64_t most_contexts, bool has_distributor,
                   const Machine& machine, const Observation& observed)
    : topology_(machine.topology),
      options_(slices_wanted(observed)),
      ray_(observed.ray),
      contexts_(static_cast<std::uint32_t>(most_contexts)),
      testers_(has_distributor ? static_cast<std::uint32_t>(testers.distributor.testers) : 1),
      per_resource_(1 + contexts_ + testers_ * static_cast<std::uint32_t>(kUnitKinds.size()) + 2),
      has_distributor_(has_distributor),
      trips_(machine.packets.size()) {
  const std::size_t nodes = topology_.resources() + topology_.hubs().size();
  for (std::size_t i = 0; i < nodes; ++i) slices_.emplace_back(options_);
  for (std::size_t i = 0; i < nodes + 1; ++i) facts_.push_back({ray_, {}});
}

Recording Recorder::of_resource(ResourceId id) {
  if (!records_slices()) return {};
  return {&slices_[id.value], &trips_, id.value * per_resource_, ray_ != nullptr ? &facts_[id.value] : nullptr,
          contexts_};
}

Recording Recorder::of_shading() {
  return {nullptr, nullptr, 0, ray_ != nullptr ? &facts_.back() : nullptr};
}

LinkRecorder Recorder::of_link(ResourceId from, std::uint32_t wire) {
  if (!records_slices()) return {};
  const auto links = static_cast<std::uint32_t>(topology_.resources()) * per_resource_;
  return {&slices_[from.value], &trips_, links + wire};
}

void Recorder::limit() {
  if (cut_ || ray_ != nullptr) return;
  const auto too_many = [this] {
    std::size_t slices = 0;
    for (const SliceLog& log : slices_) slices += log.slices().size();
    return slices >= options_.most;
  };
  while (options_.thins && too_many())
    for (SliceLog& log : slices_) log.halve();
  if (!too_many()) return;
  cut_ = true;
  for (SliceLog& log : slices_) log.stop();
}

Timeline Recorder::timeline(Cycle end) const {
  Timeline out{{}, {}, end, cut_, slices_.front().left()};
  for (std::size_t r = 0; r < topology_.resources(); ++r) {
    const std::string part = fmt::format("resource {}", r);
    out.tracks.push_back({part, "dispatch"});
    for (std::uint32_t c = 0; c < contexts_; ++c) out.tracks.push_back({part, fmt::format("test context {}", c)});
    for (std::uint32_t t = 0; t < testers_; ++t)
      for (const UnitKindRow& unit : kUnitKinds)
        out.tracks.push_back(
            {part, fmt::format("{}{} units", has_distributor_ ? fmt::format("tester {}, ", t) : "", unit.name)});
    out.tracks.push_back({part, "ray reads"});
    out.tracks.push_back({part, "primitive ray reads"});
  }
  for (std::size_t w = 0; w < topology_.wires().size(); ++w) {
    const Topology::Wire& wire = topology_.wires()[w];
    out.tracks.push_back({"links", fmt::format("link {}: {} to {}", w, wire.from.value, wire.to.value)});
  }
  for (const SliceLog& log : slices_) out.slices.insert(out.slices.end(), log.slices().begin(), log.slices().end());
  for (Slice& slice : out.slices) slice.end = std::min(slice.end, end);
  std::erase_if(out.slices, [&](const Slice& slice) { return slice.begin >= slice.end; });
  std::sort(out.slices.begin(), out.slices.end(), [](const Slice& a, const Slice& b) {
    return std::tie(a.begin, a.track, b.end, a.trip) < std::tie(b.begin, b.track, a.end, b.trip);
  });
  return out;
}

std::vector<RayFact> Recorder::facts() const {
  std::vector<RayFact> out;
  for (const RayLog& log : facts_) out.insert(out.end(), log.facts.begin(), log.facts.end());
  std::stable_sort(out.begin(), out.end(), [](const RayFact& a, const RayFact& b) { return a.at < b.at; });
  return out;
}

}  // namespace carousel::ringbus::cycle
