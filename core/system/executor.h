#pragma once

#include <cstddef>
#include <functional>
#include <memory>

namespace carousel {

/// Runs data-parallel work. The three kinds give the same results: callers write to disjoint places and
/// reduce in a fixed order.
class Executor {
 public:
  virtual ~Executor() = default;
  /// Calls `body(begin, end)` over disjoint ranges that cover [0, count), each at most `grain` long or a
  /// multiple of it; returns when all are done. An exception of a body is rethrown once.
  virtual void parallel_for(std::size_t count, std::size_t grain,
                            const std::function<void(std::size_t, std::size_t)>& body) = 0;
  /// Runs both, possibly at once. May be nested.
  virtual void invoke(const std::function<void()>& a, const std::function<void()>& b) = 0;
  virtual std::size_t threads() const = 0;
};

std::unique_ptr<Executor> make_sequential_executor();
std::unique_ptr<Executor> make_jthread_executor(std::size_t threads);
std::unique_ptr<Executor> make_tbb_executor(std::size_t threads);
/// The one that the program uses: TBB's, and that of std::jthread under ThreadSanitizer, which does not know how
/// Debian's TBB synchronises.
std::unique_ptr<Executor> make_executor(std::size_t threads);

}  // namespace carousel
