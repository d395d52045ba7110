#include "ringbus/queues/index_queue.h"

#include "ringbus/queues/queue_types.h"

namespace carousel::ringbus {

namespace {

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

}  // namespace

std::unique_ptr<IndexQueue> make_index_queue(QueueKind kind, std::size_t capacity) {
  return with_queue_type(kind, [&](auto type) -> std::unique_ptr<IndexQueue> {
    return std::make_unique<IndexQueueOf<typename decltype(type)::template Of<std::uint32_t>>>(capacity);
  });
}

}  // namespace carousel::ringbus
