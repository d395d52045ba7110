#pragma once

#include <chrono>
#include <thread>

namespace carousel::ringbus::stress {

/// Makes a refused caller wait before it calls again. As the two sides may share a core, it spins only a few times,
/// then yields, and sleeps after many refusals.
class Backoff {
 public:
  void wait() {
    if (++refusals_ <= kSpins) {
#if defined(__x86_64__)
      __builtin_ia32_pause();
#endif
    } else if (refusals_ < kYields) {
      std::this_thread::yield();
    } else {
      std::this_thread::sleep_for(std::chrono::microseconds(50));
    }
  }
  void reset() {
    refusals_ = 0;
  }

 private:
  static constexpr int kSpins = 16, kYields = 2048;
  int refusals_ = 0;
};

}  // namespace carousel::ringbus::stress
