#pragma once

#include "core/statistics/counters.h"

namespace carousel {

/// The reason why something at a resource could not proceed.
enum class StallReason : std::uint8_t {
  kNone,
  kCredits,  ///< no packet free to issue with
  kLink,     ///< the outgoing link is full
  kSlots,    ///< new rays wait for slots
  kStorage,  ///< too few free collection blocks to issue or admit
  kReserve,  ///< not a stall yet: the reserve was entered, issuing goes one packet at a time, deepest first
};

/// Stalls of a resource, by reason.
struct StallCounts {
  std::uint64_t credits = 0, link = 0, slots = 0, storage = 0, reserve = 0;

  /// In the order of StallReason.
  static constexpr auto counters() {
    using C = StallCounts;
    return std::array{
        Counter{"credits", &C::credits, "attempts", "no packet was free to issue with"},
        Counter{"link", &C::link, "attempts", "the outgoing link was full"},
        Counter{"slots", &C::slots, "attempts", "new rays waited for slots"},
        Counter{"storage", &C::storage, "attempts", "too few collection blocks were free"},
        Counter{"reserve", &C::reserve, "attempts", "the reserve was entered: one packet at a time, deepest first"},
    };
  }
  /// The counter of a reason other than kNone.
  std::uint64_t& operator[](StallReason reason) { return this->*member(reason); }
  std::uint64_t operator[](StallReason reason) const { return this->*member(reason); }
  friend bool operator==(const StallCounts&, const StallCounts&) = default;

 private:
  static constexpr Counter<StallCounts>::Member member(StallReason reason);
};

constexpr Counter<StallCounts>::Member StallCounts::member(StallReason reason) {
  return kCounters<StallCounts>[static_cast<std::size_t>(reason) - 1].member;
}

}  // namespace carousel
