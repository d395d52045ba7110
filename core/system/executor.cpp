#include "core/system/executor.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include <tbb/blocked_range.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_invoke.h>
#include <tbb/task_arena.h>

namespace carousel {

namespace {

class SequentialExecutor final : public Executor {
 public:
  void parallel_for(std::size_t count, std::size_t,
                    const std::function<void(std::size_t, std::size_t)>& body) override {
    if (count > 0) body(0, count);
  }
  void invoke(const std::function<void()>& a, const std::function<void()>& b) override {
    a();
    b();
  }
  std::size_t threads() const override { return 1; }
};

/// Keeps the first exception of several threads until they have joined.
class FirstException {
 public:
  void capture() {
    const std::lock_guard lock(mutex_);
    if (!first_) first_ = std::current_exception();
  }
  void rethrow() const {
    if (first_) std::rethrow_exception(first_);
  }

 private:
  std::mutex mutex_;
  std::exception_ptr first_;
};

class JthreadExecutor final : public Executor {
 public:
  explicit JthreadExecutor(std::size_t threads) : threads_(std::max<std::size_t>(1, threads)) {}

  void parallel_for(std::size_t count, std::size_t grain,
                    const std::function<void(std::size_t, std::size_t)>& body) override {
    grain = std::max<std::size_t>(1, grain);
    std::atomic<std::size_t> next{0};
    FirstException error;
    auto work = [&] {
      try {
        // Relaxed: the ranges are disjoint and the join publishes what the bodies wrote.
        for (std::size_t b; (b = next.fetch_add(grain, std::memory_order_relaxed)) < count;)
          body(b, std::min(count, b + grain));
      } catch (...) {
        error.capture();
      }
    };
    {
      std::vector<std::jthread> helpers;
      for (std::size_t i = 1; i < std::min(threads_, (count + grain - 1) / grain); ++i) helpers.emplace_back(work);
      work();
    }
    error.rethrow();
  }

  void invoke(const std::function<void()>& a, const std::function<void()>& b) override {
    // Relaxed: the count only limits how many threads exist, it guards no data.
    if (busy_.fetch_add(1, std::memory_order_relaxed) + 1 >= threads_) {
      busy_.fetch_sub(1, std::memory_order_relaxed);
      a();
      b();
      return;
    }
    FirstException error;
    {
      const std::jthread helper([&] {
        try {
          b();
        } catch (...) {
          error.capture();
        }
      });
      try {
        a();
      } catch (...) {
        error.capture();
      }
    }
    busy_.fetch_sub(1, std::memory_order_relaxed);
    error.rethrow();
  }

  std::size_t threads() const override { return threads_; }

 private:
  std::size_t threads_;
  std::atomic<std::size_t> busy_{0};
};

/// Has no more workers than the machine has cores: TBB would refuse the others, with a warning of its own on stderr.
class TbbExecutor final : public Executor {
 public:
  explicit TbbExecutor(std::size_t threads)
      : threads_(std::max<std::size_t>(1, threads)),
        arena_(std::min(static_cast<int>(threads_), tbb::info::default_concurrency())) {}

  void parallel_for(std::size_t count, std::size_t grain,
                    const std::function<void(std::size_t, std::size_t)>& body) override {
    arena_.execute([&] {
      tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, std::max<std::size_t>(1, grain)),
                        [&](const auto& range) { body(range.begin(), range.end()); });
    });
  }
  void invoke(const std::function<void()>& a, const std::function<void()>& b) override {
    arena_.execute([&] { tbb::parallel_invoke(a, b); });
  }
  std::size_t threads() const override { return threads_; }

 private:
  std::size_t threads_;
  tbb::task_arena arena_;
};

}  // namespace

std::unique_ptr<Executor> make_sequential_executor() {
  return std::make_unique<SequentialExecutor>();
}
std::unique_ptr<Executor> make_jthread_executor(std::size_t threads) {
  return std::make_unique<JthreadExecutor>(threads);
}
std::unique_ptr<Executor> make_tbb_executor(std::size_t threads) {
  return std::make_unique<TbbExecutor>(threads);
}
std::unique_ptr<Executor> make_executor(std::size_t threads) {
#ifdef __SANITIZE_THREAD__
  return make_jthread_executor(threads);
#else
  return make_tbb_executor(threads);
#endif
}

}  // namespace carousel
