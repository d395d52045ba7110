#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "ringbus/time/clock.h"

namespace carousel::ringbus::cycle {

/// A phase of a test context. kStarting: the dispatch stage reads the packet's IDs; kWalking: the packet's rays go
/// through a subtree by themselves.
enum class ContextPhase : std::uint8_t { kFree, kStarting, kFetching, kComputing, kWalking };

/// The phases of a resource's test contexts, at most 64: a set of contexts a phase, so that a resource asks for those
/// in a phase without a look at each of its contexts, which it does in every step.
class ContextPhases {
 public:
  using Set = std::uint64_t;

  explicit ContextPhases(std::size_t contexts)
      : all_(contexts == 64 ? ~Set{0} : (Set{1} << contexts) - 1), ends_(contexts) {
    set(ContextPhase::kFree) = all_;
  }

  /// `end`: of a phase whose end is known, kStarting or kComputing.
  void enter(std::size_t context, ContextPhase phase, Cycle end = 0) {
    const Set one = Set{1} << context;
    for (Set& set : sets_) set &= ~one;
    set(phase) |= one;
    ends_[context] = end;
  }
  Set in(ContextPhase phase) const { return sets_[static_cast<std::size_t>(phase)]; }
  bool all_free() const { return in(ContextPhase::kFree) == all_; }
  Cycle end(std::size_t context) const { return ends_[context]; }

  /// The earliest end after `now` among `contexts`; kNever if there is none.
  Cycle first_end_after(Cycle now, Set contexts) const {
    Cycle first = kNever;
    for_each(contexts, [&](std::size_t context) {
      if (const Cycle at = ends_[context]; at > now) first = std::min(first, at);
    });
    return first;
  }
  /// The latest end among `contexts`; 0 if there is none.
  Cycle last_end(Set contexts) const {
    Cycle last = 0;
    for_each(contexts, [&](std::size_t context) { last = std::max(last, ends_[context]); });
    return last;
  }
  /// Calls `call` with each context of the set, in order.
  template <class Call>
  static void for_each(Set contexts, Call&& call) {
    for (; contexts != 0; contexts &= contexts - 1) call(static_cast<std::size_t>(std::countr_zero(contexts)));
  }

 private:
  Set& set(ContextPhase phase) { return sets_[static_cast<std::size_t>(phase)]; }

  static constexpr std::size_t kPhases = static_cast<std::size_t>(ContextPhase::kWalking) + 1;
  Set all_;
  std::array<Set, kPhases> sets_{};
  std::vector<Cycle> ends_;
};

}  // namespace carousel::ringbus::cycle
