#pragma once

#include <cstdint>
#include <optional>
#include <span>

#include "accel/structure/node.h"
#include "core/statistics/bundle_counts.h"
#include "core/statistics/cull_counts.h"
#include "core/statistics/intersection_counts.h"
#include "core/statistics/stall_counts.h"
#include "core/types/ids.h"
#include "ringbus/packets/packet.h"

namespace carousel::ringbus {

enum class EventKind : std::uint8_t {
  kAdmit,     ///< `rays` new rays got slots
  kIssue,     ///< a packet left the collections of its owner with `rays` members
  kTest,      ///< a packet's `rays` local members were tested; `tests` is what it cost. 0 rays: a bubble
  kHop,       ///< a packet was sent on to a neighbour
  kRetire,    ///< a packet is back at its owner; `rays` memberships joined collections
  kComplete,  ///< `rays` rays were handed over to shading
  kStall,     ///< something could not proceed, and why
};

/// One thing that happened at a resource. The times are the engine's affair.
struct Event {
  EventKind kind;
  ResourceId resource;
  std::optional<PacketId> packet = std::nullopt;
  accel::NodeKey key{};
  std::uint32_t rays = 0;
  std::uint32_t reads = 0;  ///< kTest: records of rays and bundles that were read
  std::uint16_t depth = 0;  ///< kTest: of `key`
  IntersectionCounts tests{};
  const BundleCounts* bundles = nullptr;  ///< kTest with bundles; valid during the call only
  StallReason reason = StallReason::kNone;
  std::span<const PacketMember> members{};  ///< valid during the call only
};

/// Where events go; each resource has its own sink, called from the resource's thread. A resource without one
/// spends a predicted branch an event.
class EventSink {
 public:
  virtual ~EventSink() = default;
  virtual void record(const Event& event) = 0;
  /// Where tests add what cull planes did; null: nowhere.
  virtual CullCounts* cull_counts() { return nullptr; }
};

}  // namespace carousel::ringbus
