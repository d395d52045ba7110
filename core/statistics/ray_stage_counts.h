#pragma once

#include "core/statistics/counters.h"

namespace carousel {

/// Where a ray's cycles go, from the cycle in which it is made until it has been shaded. It is in one stage at a time.
enum class RayStage : std::uint8_t {
  kSlot,        ///< it waits for a slot
  kLoad,        ///< its record and its ID are on their way, or it waits for room in the root's collection
  kCollection,  ///< it waits in a collection
  kIssue,       ///< its packet has its shapes, and waits for dispatch
  kShapes,      ///< it waits for the shapes that it is to be tested with
  kInput,       ///< its packet waits in an input queue
  kDispatch,    ///< dispatch looks through its packet
  kOthers,      ///< its packet is held by tests of other resources' rays, and by their shapes
  kTest,        ///< it is tested, or waits for a unit
  kEgress,      ///< its packet waits for a link
  kLink,        ///< its packet is on a link
  kHome,        ///< it has been tested, and its packet goes on, until its hits have joined collections
  kOpacity,     ///< all its tests are done but for answers about opacity and visits in other contexts
  kReturn,      ///< its hit is on its way to shading
  kShadeQueue,  ///< its hit waits for data of shading, or for a shader worker
  kShading,     ///< its hit is shaded
};

/// Cycles of rays, by stage.
struct RayStageCounts {
  std::uint64_t slot = 0, load = 0, collection = 0, issue = 0, shapes = 0, input = 0, dispatch = 0, others = 0,
                test = 0, egress = 0, link = 0, home = 0, opacity = 0, to_shading = 0, shade_queue = 0, shading = 0;

  /// In the order of RayStage.
  static constexpr auto counters() {
    using C = RayStageCounts;
    return std::array{
        Counter{"slot", &C::slot, "cycles", "rays waited for a slot"},
        Counter{"load", &C::load, "cycles",
                "records and IDs were on their way to resources, or waited for room in the root's collection"},
        Counter{"collection", &C::collection, "cycles", "rays waited in collections"},
        Counter{"issue", &C::issue, "cycles", "their packets had their shapes, and waited to be issued"},
        Counter{"shapes", &C::shapes, "cycles", "they waited for the shapes that they were to be tested with"},
        Counter{"input", &C::input, "cycles", "their packets waited in input queues"},
        Counter{"dispatch", &C::dispatch, "cycles", "dispatch stages looked through their packets"},
        Counter{"others", &C::others, "cycles",
                "their packets were held by tests of other resources' rays, or by the shapes of these"},
        Counter{"test", &C::test, "cycles", "they were tested, or waited for a test unit"},
        Counter{"egress", &C::egress, "cycles", "their packets waited for a link"},
        Counter{"link", &C::link, "cycles", "their packets were on links"},
        Counter{"home", &C::home, "cycles",
                "they had been tested, and their packets went on, until their hits had joined collections"},
        Counter{"opacity", &C::opacity, "cycles", "only answers about opacity, or tests in other contexts, were due"},
        Counter{"to_shading", &C::to_shading, "cycles", "their hits were on their way to shading"},
        Counter{"shade_queue", &C::shade_queue, "cycles", "their hits waited for a shader worker"},
        Counter{"shading", &C::shading, "cycles", "their hits were shaded"},
    };
  }
  std::uint64_t& operator[](RayStage stage) { return this->*member(stage); }
  std::uint64_t operator[](RayStage stage) const { return this->*member(stage); }
  friend bool operator==(const RayStageCounts&, const RayStageCounts&) = default;

 private:
  static constexpr Counter<RayStageCounts>::Member member(RayStage stage);
};

constexpr Counter<RayStageCounts>::Member RayStageCounts::member(RayStage stage) {
  return kCounters<RayStageCounts>[static_cast<std::size_t>(stage)].member;
}

/// In all stages together.
constexpr std::uint64_t cycles_of(const RayStageCounts& counts) {
  std::uint64_t sum = 0;
  for (const auto& row : kCounters<RayStageCounts>) sum += row.value(counts);
  return sum;
}

}  // namespace carousel
