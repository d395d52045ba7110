#pragma once

#include <vector>

#include "core/config.h"

namespace carousel::ringbus {

/// The queues a test may use: ThreadSanitizer reports Debian's TBB, whose inside it cannot see.
inline std::vector<QueueKind> queue_kinds() {
#ifdef __SANITIZE_THREAD__
  return {QueueKind::kSpscRing, QueueKind::kMutex};
#else
  return {QueueKind::kSpscRing, QueueKind::kTbbBounded, QueueKind::kMutex};
#endif
}

}  // namespace carousel::ringbus
