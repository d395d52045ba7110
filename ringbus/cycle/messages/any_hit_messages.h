#pragma once

#include <cstdint>
#include <vector>

#include "core/types/workload.h"
#include "ringbus/time/channel_list.h"

namespace carousel::ringbus::cycle {

/// A resource asks shading, with `testers.any_hit: shader`, to run the any-hit calls of some rays.
struct AnyHitQuestion {
  std::vector<std::uint32_t> slots;  ///< slots of the rays, which are held until the answer comes
  HitBatch calls{};                  ///< of all rays: each with the place of the call for its hit

  /// The ID of each ray, and for each call instance, primitive, u and v.
  std::uint64_t bytes() const { return 4 * slots.size() + 16 * calls.size(); }
};

/// The calls of these rays have been answered. The resource has long known the answers: only the time is simulated.
struct AnyHitAnswer {
  std::vector<std::uint32_t> slots;

  /// The ID of each ray, and the distance of its closest hit.
  std::uint64_t bytes() const { return 8 * slots.size(); }
};

struct AnyHitKinds {
  MessageKind questions, answers;
  /// `width` of the wires in bytes a cycle.
  AnyHitKinds(ChannelList& list, std::uint64_t width)
      : questions(list.carry({"any-hit questions", "resources", "shading", "wires of questions", width})),
        answers(list.carry({"any-hit answers", "shading", "resources", "wires of answers", width})) {}
};

}  // namespace carousel::ringbus::cycle
