#pragma once

#include <chrono>
#include <thread>

namespace carousel::ringbus::stress {

/// What a refused caller does before it insists. The two sides may share a core: after a moment's hope it yields, and
/// after many refusals it sleeps.
class Backoff {
 public:
  void wait() {
    if (++refusals_ <= kHope) {
#if defined(__x86_64__)
      __builtin_ia32_pause();
#endif
    } else if (refusals_ < kPatience) {
      std::this_thread::yield();
    } else {
      std::this_thread::sleep_for(std::chrono::microseconds(50));
    }
  }
  void reset() {
    refusals_ = 0;
  }

 private:
  static constexpr int kHope = 16, kPatience = 2048;
  int refusals_ = 0;
};

}  // namespace carousel::ringbus::stress
