#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "ringbus/stress/pattern.h"
#include "ringbus/stress/violations.h"

namespace carousel::ringbus::stress {

/// A property of a library's queue that some pattern shows as a fault, and that its design explains.
struct ExpectedProperty {
  std::string_view queue;  ///< as the configuration names it
  Pattern pattern;
  std::uint64_t Violations::*kind;  ///< the only fault that it explains
  std::string_view why;             ///< a clause, with its source
};

inline constexpr std::string_view kOvertaken =
    "a producer that is suspended between its ticket and its cell is overtaken by one whose ticket is a whole round "
    "later, whose earlier messages then come after that: AtomicQueueCommon::do_push_any in atomic_queue.h";

/// The one table of them. The patterns are those in which several producers share a queue.
inline constexpr auto kExpectedProperties = std::to_array<ExpectedProperty>({
    {"atomic_queue", Pattern::kHotspot, &Violations::reordered, kOvertaken},
    {"atomic_queue", Pattern::kManyToMany, &Violations::reordered, kOvertaken},
    {"atomic_queue", Pattern::kOversubscribed, &Violations::reordered, kOvertaken},
});

/// The property that explains every fault found of a queue under a pattern; empty if there are no faults, or others.
inline std::string expected_of(std::string_view queue, Pattern pattern, const Violations& found) {
  if (!found.any()) return "";
  for (const ExpectedProperty& row : kExpectedProperties) {
    if (row.queue != queue || row.pattern != pattern) continue;
    Violations others = found;
    others.*row.kind = 0;
    if (!others.any()) return std::string(row.why);
  }
  return "";
}

}  // namespace carousel::ringbus::stress
