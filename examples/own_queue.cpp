// A queue of one's own as the links of the ring.
//
// The queue is FastForward: every cell says by itself whether it is full, so neither side reads the other's index.
// J. Giacomoni, T. Moseley, M. Vachharajani, "FastForward for Efficient Pipeline Parallelism: A Cache-Optimized
// Concurrent Lock-Free Queue", PPoPP 2008. docs/queues.md has the contract of a queue.
#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdio>
#include <span>
#include <vector>

#include "app/run/prepare.h"
#include "app/run/render_job.h"
#include "ringbus/native/native_engine.h"
#include "ringbus/queues/link_queue.h"
#include "ringbus/stress/trial.h"

namespace {

namespace app = carousel::app;
namespace ringbus = carousel::ringbus;
using ringbus::Parties;

template <class T>
class FastForward {
 public:
  static constexpr Parties kProducers = Parties::kOne, kConsumers = Parties::kOne;
  explicit FastForward(std::size_t capacity) : cells_(capacity) {}

  bool try_push(const T& value) {
    Cell& cell = cells_[tail_];
    if (cell.full.load(std::memory_order_acquire)) return false;  // pairs with the release in try_pop
    cell.value = value;
    cell.full.store(true, std::memory_order_release);
    tail_ = after(tail_);
    return true;
  }
  bool try_pop(T& value) {
    Cell& cell = cells_[head_];
    if (!cell.full.load(std::memory_order_acquire)) return false;  // pairs with the release in try_push
    value = cell.value;
    cell.full.store(false, std::memory_order_release);
    head_ = after(head_);
    return true;
  }
  std::size_t try_push_n(std::span<const T> values) { return ringbus::push_one_by_one(*this, values); }
  std::size_t try_pop_n(std::span<T> values) { return ringbus::pop_one_by_one(*this, values); }
  /// Cells are freed in their order, so the empty ones follow the producer's place.
  std::size_t free_places() const {
    std::size_t count = 0;
    for (std::size_t at = tail_; count < cells_.size(); ++count, at = after(at))
      if (cells_[at].full.load(std::memory_order_acquire)) break;
    return count;
  }
  std::size_t capacity() const { return cells_.size(); }

 private:
  struct Cell {
    std::atomic<bool> full{false};
    T value{};
  };
  std::size_t after(std::size_t at) const { return at + 1 == cells_.size() ? 0 : at + 1; }

  std::vector<Cell> cells_;
  alignas(128) std::size_t tail_ = 0;  // the producer's
  alignas(128) std::size_t head_ = 0;  // the consumer's
};

/// Hits of a small picture, in a text that is equal for equal hits.
std::string hits_through(const app::Prepared& prepared, bool own) {
  const carousel::Config& config = prepared.config();
  const app::RenderJob job(prepared);
  ringbus::RunOptions options;
  options.threads = prepared.threads;
  const float size = prepared.scene_size();
  const ringbus::RunResult result = own ? ringbus::run_native_on(ringbus::make_queue_link<FastForward>, config,
                                                                 prepared.accel, size, job.workload(), options)
                                        : ringbus::run_native(config, prepared.accel, size, job.workload(), options);
  std::printf("%-12s %llu rays in %.3f s, hits %s\n", own ? "FastForward" : "spsc_ring",
              static_cast<unsigned long long>(result.rays_completed), result.wall_seconds, job.hits_digest().c_str());
  return job.hits_digest();
}

}  // namespace

int main() {
  // Alone, under a pattern of the queue laboratory, which checks every message.
  ringbus::stress::TrialOptions trial;
  trial.messages = 20'000;
  const auto alone = ringbus::stress::run_trial(ringbus::stress::queue_under_test<FastForward>("FastForward"), trial);
  std::printf("stream       %llu messages, violations: %s\n", static_cast<unsigned long long>(alone.messages),
              alone.violations.any() ? alone.violations.names().c_str() : "none");

  // As the links of a ring: the hits are those of the built-in queue.
  const app::Prepared prepared = app::prepare_config(
      "{scene: {builtin: cornell}, image: {width: 32, height: 32}, topology: {resources: 4}}", "own_queue.yaml");
  const bool same = hits_through(prepared, false) == hits_through(prepared, true);
  std::printf("%s\n", same ? "The hits are the same." : "The hits DIFFER.");
  return same && !alone.violations.any() ? 0 : 1;
}
