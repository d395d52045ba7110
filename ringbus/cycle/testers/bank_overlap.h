#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "ringbus/cycle/testers/unit_bank.h"
#include "ringbus/results/cycle_result.h"

namespace carousel::ringbus::cycle {

/// What the banks of a resource do together: the cycles in which any of them is busy, and those in which none is while
/// answers to earlier tests are awaited. Banks forget the times that they have accounted, so these are taken before.
class BankOverlap {
 public:
  /// `after`: cycles from the last answer of a strip until it counts.
  explicit BankOverlap(Cycle after) : after_(after) {}

  /// Answers of tests that a bank starts at `from`, each with the one before, come until `until`: longer than the bank
  /// is busy. To be said before advance() passes `from`.
  void expect(Cycle from, Cycle until) { chains_.push_back({from, until + after_}); }

  /// Takes the banks' times from the last call until `now`. Calls `each` with a function that takes a bank, which it
  /// must call for every bank. Times of calls must not decrease.
  template <class Each>
  void advance(Cycle now, const Each& each) {
    if (now <= seen_) return;
    lanes_.clear();
    each([&](const UnitBank& bank) {
      if (bank.works_before(now)) lanes_.push_back({&bank, 0, bank.span(0)});
    });
    Cycle at = seen_;
    while (lanes_.size() > 1) {
      Lane& first = *std::min_element(lanes_.begin(), lanes_.end(),
                                      [](const Lane& a, const Lane& b) { return a.span.begin < b.span.begin; });
      if (!take_span(first, at, now)) lanes_.erase(lanes_.begin() + (&first - lanes_.data()));
    }
    if (!lanes_.empty())  // mostly there is no more than one
      while (take_span(lanes_.front(), at, now)) {
      }
    if (now > at) wait(at, now);
    seen_ = now;
  }

  /// The cycles since the last call, up to the last advance().
  TestingCycles take() {
    const TestingCycles out{so_far_.any - taken_.any, so_far_.latency - taken_.latency};
    taken_ = so_far_;
    return out;
  }

 private:
  struct Lane {
    const UnitBank* bank;
    std::size_t index;
    UnitBank::Span span;
  };

  struct Chain {
    Cycle from, until;
  };

  /// Takes the earliest of all spans. Returns whether its bank has another one that begins before `now`.
  bool take_span(Lane& lane, Cycle& at, Cycle now) {
    const UnitBank::Span span = lane.span;
    if (span.begin > at) wait(at, span.begin);
    at = std::max(at, span.begin);
    if (const Cycle end = std::min(span.end, now); end > at) {
      so_far_.any += end - at;
      at = end;
    }
    answered_ = std::max(answered_, span.end - lane.bank->interval() + lane.bank->latency() + after_);
    if (!chains_.empty())
      std::erase_if(chains_, [&](const Chain& chain) {
        if (chain.from >= span.end) return false;
        answered_ = std::max(answered_, chain.until);
        return true;
      });
    if (!lane.bank->has_span(++lane.index)) return false;
    lane.span = lane.bank->span(lane.index);
    return lane.span.begin < now;
  }
  /// No bank is busy.
  void wait(Cycle begin, Cycle end) {
    if (answered_ > begin) so_far_.latency += std::min(answered_, end) - begin;
  }

  std::vector<Lane> lanes_;    // scratch: banks with times that are not taken yet
  std::vector<Chain> chains_;  // whose first tests are in spans that are not taken yet
  Cycle after_, seen_ = 0, answered_ = 0;
  TestingCycles so_far_, taken_;
};

}  // namespace carousel::ringbus::cycle
