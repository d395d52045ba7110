#include "ringbus/stress/delivery_checker.h"

#include <algorithm>
#include <bit>

#include <fmt/format.h>

namespace carousel::ringbus::stress {

DeliveryChecker::DeliveryChecker(std::size_t producers, std::uint64_t most) : most_(most), from_(producers) {
  for (From& from : from_) from.seen.resize(most / 64 + 1);
}

void DeliveryChecker::corrupted() {
  ++violations_.corrupted;
  if (violations_.detail.empty()) violations_.detail = fmt::format("arrival {} is not what anybody sent", taken_ - 1);
}

void DeliveryChecker::misplaced(From& from, Origin origin, bool again) {
  if (again) {
    ++violations_.doubled;
  } else {
    ++violations_.reordered;
    from.seen[origin.number / 64] |= std::uint64_t{1} << (origin.number % 64);
  }
  if (violations_.detail.empty())
    violations_.detail = fmt::format("message {} of producer {} came {} message {}", origin.number, origin.producer,
                                     again ? "again, after" : "after", from.next - 1);
}

Violations DeliveryChecker::judge(std::span<const DeliveryChecker> consumers, std::span<const std::uint64_t> sent) {
  Violations out;
  for (const DeliveryChecker& one : consumers) out += one.violations_;
  for (std::size_t p = 0; p < sent.size(); ++p) {
    std::uint64_t missing = 0, first = 0;
    for (std::uint64_t base = 0; base < sent[p]; base += 64) {
      std::uint64_t seen = 0;
      for (const DeliveryChecker& one : consumers) {
        const std::uint64_t here = one.from_[p].seen[base / 64];
        out.doubled += static_cast<std::uint64_t>(std::popcount(seen & here));  // received by two consumers
        seen |= here;
      }
      const std::uint64_t wanted =
          sent[p] - base >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << (sent[p] - base)) - 1;
      const std::uint64_t gone = wanted & ~seen;
      if (missing == 0 && gone != 0) first = base + static_cast<std::uint64_t>(std::countr_zero(gone));
      missing += static_cast<std::uint64_t>(std::popcount(gone));
    }
    out.lost += missing;
    if (missing > 0 && out.detail.empty()) out.detail = fmt::format("message {} of producer {} never came", first, p);
  }
  // A corrupted message is also missing under its own number, but counts once.
  out.lost -= std::min(out.lost, out.corrupted);
  return out;
}

}  // namespace carousel::ringbus::stress
