#include "tests/ringbus/schedule/fibre.h"

#include <exception>
#include <new>
#include <utility>

#include <sys/mman.h>

#if defined(__SANITIZE_ADDRESS__)
#define CAROUSEL_FIBRES_TOLD 1
#elif defined(__has_feature)
#if __has_feature(address_sanitizer)
#define CAROUSEL_FIBRES_TOLD 1
#endif
#endif
#ifdef CAROUSEL_FIBRES_TOLD
#include <sanitizer/common_interface_defs.h>
#endif

namespace carousel::ringbus {

namespace {

// The two ends of the switch under way: enter() has no arguments.
thread_local Fibre* fibre_entered = nullptr;
thread_local Fibre* fibre_left = nullptr;

// AddressSanitizer has to be told when another stack is used.
void tell_leaving([[maybe_unused]] void** shadow, [[maybe_unused]] void* stack, [[maybe_unused]] std::size_t bytes) {
#ifdef CAROUSEL_FIBRES_TOLD
  __sanitizer_start_switch_fiber(shadow, stack, bytes);
#endif
}
void tell_entered([[maybe_unused]] void* shadow, [[maybe_unused]] void** stack, [[maybe_unused]] std::size_t* bytes) {
#ifdef CAROUSEL_FIBRES_TOLD
  const void* bottom = nullptr;
  __sanitizer_finish_switch_fiber(shadow, &bottom, bytes);
  *stack = const_cast<void*>(bottom);
#endif
}

}  // namespace

Fibre::Fibre(std::function<void()> body) : body_(std::move(body)), stack_bytes_(kStackBytes), started_(false) {
  stack_ = mmap(nullptr, stack_bytes_, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_STACK, -1, 0);
  if (stack_ == MAP_FAILED || getcontext(&start_) != 0) throw std::bad_alloc();
  constexpr std::size_t kGuard = 4096;
  mprotect(stack_, kGuard, PROT_NONE);
  start_.uc_stack.ss_sp = stack_;
  start_.uc_stack.ss_size = stack_bytes_;
  start_.uc_link = nullptr;
  makecontext(&start_, &Fibre::enter, 0);
}

Fibre::~Fibre() {
  if (body_) munmap(stack_, stack_bytes_);
}

void Fibre::resume(Fibre& running) {
  fibre_entered = this;
  fibre_left = &running;
  tell_leaving(&running.shadow_, stack_, stack_bytes_);
  if (__builtin_setjmp(running.registers_.data()) == 0) jump();
  tell_entered(running.shadow_, &fibre_left->stack_, &fibre_left->stack_bytes_);
}

[[gnu::noinline]] void Fibre::jump() {
  if (started_) __builtin_longjmp(registers_.data(), 1);
  started_ = true;
  setcontext(&start_);
  std::terminate();
}

void Fibre::enter() {
  Fibre& self = *fibre_entered;
  tell_entered(nullptr, &fibre_left->stack_, &fibre_left->stack_bytes_);
  self.body_();
  std::terminate();
}

}  // namespace carousel::ringbus
