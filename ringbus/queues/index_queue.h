#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>

#include "core/config/fields/queue_kind.h"
#include "ringbus/queues/link_queue.h"

namespace carousel::ringbus {

/// A queue of indices whose design is known when the program runs: a LinkQueue (link_queue.h) behind virtual calls, for
/// things that come some hundred rays at a time.
class IndexQueue {
 public:
  virtual ~IndexQueue() = default;
  virtual bool try_push(std::uint32_t index) = 0;
  virtual bool try_pop(std::uint32_t& index) = 0;
};

/// Any LinkQueue as an IndexQueue.
template <class Queue>
class IndexQueueOf final : public IndexQueue {
  static_assert(LinkQueue<Queue, std::uint32_t>);

 public:
  explicit IndexQueueOf(std::size_t capacity) : queue_(capacity) {}
  bool try_push(std::uint32_t index) override { return queue_.try_push(index); }
  bool try_pop(std::uint32_t& index) override { return queue_.try_pop(index); }

 private:
  Queue queue_;
};

std::unique_ptr<IndexQueue> make_index_queue(QueueKind kind, std::size_t capacity);

}  // namespace carousel::ringbus
