#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "ringbus/stress/message.h"
#include "ringbus/stress/violations.h"

namespace carousel::ringbus::stress {

/// Checks the messages that one consumer receives from each producer. One thread uses it.
class DeliveryChecker {
 public:
  /// `most`: how many messages a producer may send.
  DeliveryChecker(std::size_t producers, std::uint64_t most);

  /// Returns the origin of a message; empty if the message is corrupted.
  template <std::size_t kBytes>
  std::optional<Origin> take(const Message<kBytes>& message) {
    ++taken_;
    std::optional<Origin> origin = message.open();
    if (!origin || origin->producer >= from_.size() || origin->number >= most_) {
      corrupted();
      return std::nullopt;
    }
    note(*origin);
    return origin;
  }
  /// Notes a message that is known to be undamaged.
  void note(Origin origin) {
    From& from = from_[origin.producer];
    std::uint64_t& word = from.seen[origin.number / 64];
    const std::uint64_t bit = std::uint64_t{1} << (origin.number % 64);
    if ((word & bit) != 0 || origin.number < from.next) return misplaced(from, origin, (word & bit) != 0);
    word |= bit;
    from.next = std::uint64_t{origin.number} + 1;
  }

  std::uint64_t taken() const { return taken_; }

  /// Sums up all consumers; `sent`: how many of each producer's pushes succeeded.
  static Violations judge(std::span<const DeliveryChecker> consumers, std::span<const std::uint64_t> sent);

 private:
  struct From {
    std::uint64_t next = 0;           // the number after the latest one
    std::vector<std::uint64_t> seen;  // a bit for each message
  };
  void corrupted();
  void misplaced(From& from, Origin origin, bool again);

  std::uint64_t most_, taken_ = 0;
  std::vector<From> from_;
  Violations violations_;
};

}  // namespace carousel::ringbus::stress
