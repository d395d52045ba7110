#pragma once

#include <vector>

#include "core/config/config.h"

namespace carousel::ringbus {

/// The queues that a test may use. ThreadSanitizer reports Debian's TBB, whose code is not instrumented, and
/// moodycamel's queue, whose atomic fences it does not model.
inline std::vector<QueueKind> queue_kinds() {
#ifdef __SANITIZE_THREAD__
  return {QueueKind::kSpscRing, QueueKind::kMpmcRing, QueueKind::kAtomicQueue, QueueKind::kBoostSpsc,
          QueueKind::kMutex};
#else
  return {QueueKind::kSpscRing,    QueueKind::kMpmcRing,  QueueKind::kTbbBounded, QueueKind::kMoodycamel,
          QueueKind::kAtomicQueue, QueueKind::kBoostSpsc, QueueKind::kMutex};
#endif
}

/// The kinds of queue_kinds() that serve several threads on both sides.
inline std::vector<QueueKind> many_to_many_kinds() {
  std::vector<QueueKind> kinds = queue_kinds();
  std::erase_if(kinds, [](QueueKind kind) { return kind == QueueKind::kSpscRing || kind == QueueKind::kBoostSpsc; });
  return kinds;
}

}  // namespace carousel::ringbus
