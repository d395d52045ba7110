#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "accel/structure/node.h"
#include "core/types/ray.h"
#include "core/types/workload.h"
#include "ringbus/packets/packet.h"
#include "ringbus/rays/ray_id.h"

namespace carousel::ringbus {

/// The one ray whose life is recorded. A workload that knows the rays' pixels names it before the engine sees it; the
/// engine notes where it lives. Whoever meets the ray has been passed it by those who wrote here, by way of a queue or
/// of a barrier between windows, so that relaxed accesses do.
class FollowedRay {
 public:
  /// From now on it is the ray of this tag.
  void name(const RayTag& tag) { tag_.store(bits(tag), std::memory_order_relaxed); }
  /// It is over, or never came; its tag may be used again.
  void forget() { tag_.store(0, std::memory_order_relaxed); }
  bool is(const RayTag& tag) const { return tag_.load(std::memory_order_relaxed) == bits(tag); }

  /// It has got a slot, or has left it.
  void place(RayId id) { id_.store(std::uint64_t{1} << 32 | id.bits, std::memory_order_relaxed); }
  void leave() { id_.store(0, std::memory_order_relaxed); }
  bool is(RayId id) const { return id_.load(std::memory_order_relaxed) == (std::uint64_t{1} << 32 | id.bits); }
  /// Its place among the members of a packet.
  std::optional<std::size_t> find(std::span<const PacketMember> members) const {
    for (std::size_t i = 0; i < members.size(); ++i)
      if (is(members[i].ray)) return i;
    return std::nullopt;
  }

 private:
  static std::uint64_t bits(const RayTag& tag) {
    return std::uint64_t{1} << 63 | std::uint64_t{tag.path} << 24 | std::uint64_t(tag.kind) << 16 |
           std::uint64_t{tag.bounce} << 8 | tag.index;
  }

  std::atomic<std::uint64_t> tag_{0}, id_{0};
};

/// Something that happened to the followed ray.
struct RayFact {
  enum class Kind : std::uint8_t {
    kMade,      ///< a worker made it, from `at` to `end`
    kPlaced,    ///< it got a slot of `resource`; it is loaded, and its ID reaches resource `other`, at `end`
    kAdmitted,  ///< it joined the root's collection at `resource`
    kIssued,    ///< it was taken from the collection of `key` into a packet of `resource`, with `rays` rays
    kTested,    ///< that packet was tested at `resource`: `mask` has a bit for each lane that was hit
    kRetired,   ///< the packet came back to `resource`: the ray joined the collections of the children that it hit
    kFetched,   ///< without packets: it waited from `at` to `end` for the shapes of `key`
    kWalked,    ///< likewise: it was tested against them, from `at` to `end`
    kDone,      ///< `resource` handed it over with `hit`
    kTaken,     ///< shading received it
    kShaded,    ///< a worker shaded it, from `at` to `end`
  };
  Kind kind = Kind::kMade;
  std::uint64_t at = 0, end = 0;
  std::uint64_t trip = 0;  ///< trip of the packet, as in Slice
  std::uint32_t resource = 0, other = 0, packet = 0, rays = 0;
  accel::NodeKey key{};
  std::uint16_t depth = 0;
  std::uint8_t mask = 0;
  Hit hit{};
  RayTag tag{};
};

/// Facts of one agent or thread, in the order of time.
struct RayLog {
  FollowedRay* ray = nullptr;
  std::vector<RayFact> facts;
};

}  // namespace carousel::ringbus
