#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "accel/structure/node.h"
#include "core/statistics/bundle_counts.h"
#include "core/statistics/cull_counts.h"
#include "core/statistics/intersection_counts.h"
#include "core/statistics/node_counts.h"
#include "core/statistics/stall_counts.h"
#include "core/types/ids.h"
#include "ringbus/packets/packet.h"

namespace carousel::ringbus {

enum class EventKind : std::uint8_t {
  kAdmit,     ///< `rays` new rays got slots
  kIssue,     ///< a packet left the collections of its owner with `rays` members
  kTest,      ///< a packet's `rays` local members were tested; `tests` are their cost. 0 rays: an idle visit
  kHop,       ///< a packet was sent on to a neighbour
  kRetire,    ///< a packet is back at its owner; `rays` memberships joined collections
  kPart,      ///< some members of a packet are, before the others; likewise
  kComplete,  ///< `rays` rays were handed over to shading
  kStall,     ///< something could not proceed; `reason` says why
};

/// One thing that happened at a resource. Its time is known to the engine.
struct Event {
  EventKind kind;
  ResourceId resource;
  std::optional<PacketId> packet = std::nullopt;
  accel::NodeKey key{};
  std::uint32_t rays = 0;
  std::uint32_t reads = 0;                    ///< kTest: records of rays and bundles that were read
  std::uint64_t tested = 0;                   ///< kTest: rays, those of bundles included
  std::uint32_t children = 0, misses = 0;     ///< kTest: as in TestOutcome
  std::uint16_t depth = 0;                    ///< kTest: of `key`
  const IntersectionCounts* tests = nullptr;  ///< kTest; valid during the call only
  const BundleCounts* bundles = nullptr;      ///< kTest with bundles; valid during the call only
  std::span<const NodeCountsAtDepth> runs{};  ///< kTest: as in TestOutcome; likewise
  StallReason reason = StallReason::kNone;
  std::span<const PacketMember> members{};  ///< valid during the call only
};

/// Receives the events of one resource, on that resource's thread. A resource without a sink spends a predicted branch
/// on each event.
class EventSink {
 public:
  virtual ~EventSink() = default;
  virtual void record(const Event& event) = 0;
  /// Counters that tests add to when cull planes reject something; may be null.
  virtual CullCounts* cull_counts() { return nullptr; }
};

}  // namespace carousel::ringbus
