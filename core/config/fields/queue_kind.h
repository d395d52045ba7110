#pragma once

#include "core/config/fields/field.h"

namespace carousel {

/// The designs of queue between threads of the native engine; ringbus/queues has one file each.
enum class QueueKind { kSpscRing, kMpmcRing, kTbbBounded, kMoodycamel, kAtomicQueue, kBoostSpsc, kMutex };
template <>
inline constexpr auto kEnumNames<QueueKind> = [] {
  using enum QueueKind;
  return names<QueueKind>({{kSpscRing, "spsc_ring"},
                           {kMpmcRing, "mpmc_ring"},
                           {kTbbBounded, "tbb_bounded"},
                           {kMoodycamel, "moodycamel"},
                           {kAtomicQueue, "atomic_queue"},
                           {kBoostSpsc, "boost_spsc"},
                           {kMutex, "mutex"}});
}();

template <>
inline constexpr std::string_view kAddedAs<QueueKind> = "queue";

/// A queue that hands rays over between threads of the native engine.
struct RayQueueConfig {
  QueueKind kind = QueueKind::kMpmcRing;
  std::int64_t depth = 16;
};

}  // namespace carousel
