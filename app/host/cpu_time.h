#pragma once

#include <ctime>

namespace carousel::app {

/// CPU time of this thread: wall time, without the time that other programs took.
inline double thread_cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

}  // namespace carousel::app
