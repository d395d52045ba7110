#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "ringbus/packets/packet.h"

namespace carousel::ringbus {

/// A resource's own packets that are at home, by direction. Directions take turns.
class FreePackets {
 public:
  /// Packets `first`, `first + 1`, ... : `per_direction` of direction 0, then of direction 1 and so on; all are free.
  FreePackets(PacketId first, std::size_t directions, std::uint32_t per_direction) : free_(directions) {
    for (std::size_t d = 0; d < directions; ++d)
      for (std::uint32_t i = 0; i < per_direction; ++i)
        free_[d].push_back(PacketId(first.value + static_cast<std::uint32_t>(d) * per_direction + i));
  }

  /// The packet that take() would take now. To look costs no direction its turn.
  std::optional<PacketId> front() const {
    for (std::size_t i = 0; i < free_.size(); ++i)
      if (const std::vector<PacketId>& free = free_[direction(i)]; !free.empty()) return free.back();
    return std::nullopt;
  }
  /// Takes a packet of the next direction that has one and that `may_leave(direction)`.
  template <class MayLeave>
  std::optional<PacketId> take(const MayLeave& may_leave) {
    for (std::size_t i = 0; i < free_.size(); ++i) {
      const std::size_t d = direction(i);
      if (free_[d].empty() || !may_leave(d)) continue;
      const PacketId id = free_[d].back();
      free_[d].pop_back();
      turn_ = d + 1 < free_.size() ? d + 1 : 0;
      return id;
    }
    return std::nullopt;
  }
  std::optional<PacketId> take() {
    return take([](std::size_t) { return true; });
  }
  void put(PacketId id, std::uint16_t direction) { free_[direction].push_back(id); }

  bool none() const {
    return std::all_of(free_.begin(), free_.end(), [](const std::vector<PacketId>& free) { return free.empty(); });
  }
  std::size_t count() const {
    std::size_t count = 0;
    for (const std::vector<PacketId>& free : free_) count += free.size();
    return count;
  }

 private:
  /// The i-th direction from the one whose turn it is.
  std::size_t direction(std::size_t i) const { return turn_ + i < free_.size() ? turn_ + i : turn_ + i - free_.size(); }

  std::vector<std::vector<PacketId>> free_;
  std::size_t turn_ = 0;
};

}  // namespace carousel::ringbus
