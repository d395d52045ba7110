#pragma once

#include <array>
#include <cstddef>
#include <functional>

#include <ucontext.h>

namespace carousel::ringbus {

/// A flow of control with a stack of its own, which runs when another one of the same thread switches to it. A switch
/// takes some nanoseconds, since no signal mask is saved, for which ucontext calls the kernel. Fibres are of use under
/// AddressSanitizer too; ThreadSanitizer does not know them.
class Fibre {
 public:
  /// The flow of control of the calling thread.
  Fibre() = default;
  /// One with a stack that executes `body`, from the first switch to it on. `body` must not return or throw.
  explicit Fibre(std::function<void()> body);
  ~Fibre();
  Fibre(const Fibre&) = delete;
  Fibre& operator=(const Fibre&) = delete;

  /// Leaves `running`, which calls, and goes on with this fibre. Returns when something switches to `running`.
  void resume(Fibre& running);

 private:
  static constexpr std::size_t kStackBytes = std::size_t{1} << 18;

  static void enter();
  [[noreturn]] void jump();

  std::function<void()> body_;
  void* stack_ = nullptr;  // the lowest address
  std::size_t stack_bytes_ = 0;
  bool started_ = true;
  ucontext_t start_{};
  std::array<void*, 5> registers_{};  // saved by __builtin_setjmp
  void* shadow_ = nullptr;            // AddressSanitizer's
};

}  // namespace carousel::ringbus
