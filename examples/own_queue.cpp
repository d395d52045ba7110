// A queue as a plugin, `topology.link.queue: fast_forward`.
//
// The queue is FastForward: every cell says by itself whether it is full, so neither side reads the other's index.
// J. Giacomoni, T. Moseley, M. Vachharajani, "FastForward for Efficient Pipeline Parallelism: A Cache-Optimized
// Concurrent Lock-Free Queue", PPoPP 2008. docs/guides/queues.md has the contract of a queue.
#include <algorithm>
#include <atomic>
#include <cstddef>
#include <span>
#include <vector>

#include "ringbus/plugin/bring.h"
#include "ringbus/queues/link_queue.h"

namespace {

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

}  // namespace

extern "C" const carousel::PluginInfo* carousel_plugin() {
  static const carousel::PluginInfo info = carousel::plugin("FastForward", "1.0", [](carousel::PluginParts& parts) {
    ringbus::bring_queue<FastForward>(parts, "fast_forward");
  });
  return &info;
}
