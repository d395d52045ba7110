#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <span>
#include <string>

#include "core/config/fields/queue_kind.h"
#include "ringbus/queues/link_queue.h"
#include "ringbus/stress/message.h"

namespace carousel::ringbus::stress {

/// A queue of any design. The indirect call costs every design the same nanosecond or two.
template <class T>
class AnyQueue {
 public:
  virtual ~AnyQueue() = default;
  virtual bool try_push(const T& value) = 0;
  virtual bool try_pop(T& value) = 0;
  virtual std::size_t try_push_n(std::span<const T> values) = 0;
  virtual std::size_t try_pop_n(std::span<T> values) = 0;
  virtual std::size_t free_places() = 0;
  virtual std::size_t capacity() const = 0;
};

template <std::size_t kBytes>
using MakeQueue = std::function<std::unique_ptr<AnyQueue<Message<kBytes>>>(std::size_t capacity)>;

/// A queue design that is tried: its name, how many producers and consumers it serves, and how to make one for each
/// size of message.
struct QueueUnderTest {
  std::string name;
  Parties producers = Parties::kOne, consumers = Parties::kOne;
  MakeQueue<kSmall> make_small;
  MakeQueue<kLine> make_line;
  MakeQueue<kPacket> make_packet;

  template <std::size_t kBytes>
  const MakeQueue<kBytes>& make() const {
    if constexpr (kBytes == kSmall)
      return make_small;
    else if constexpr (kBytes == kLine)
      return make_line;
    else
      return make_packet;
  }
};

template <class Queue, class T>
class QueueOf final : public AnyQueue<T> {
  static_assert(LinkQueue<Queue, T>);

 public:
  explicit QueueOf(std::size_t capacity) : queue_(capacity) {}
  bool try_push(const T& value) override { return queue_.try_push(value); }
  bool try_pop(T& value) override { return queue_.try_pop(value); }
  std::size_t try_push_n(std::span<const T> values) override { return queue_.try_push_n(values); }
  std::size_t try_pop_n(std::span<T> values) override { return queue_.try_pop_n(values); }
  std::size_t free_places() override { return queue_.free_places(); }
  std::size_t capacity() const override { return queue_.capacity(); }

 private:
  Queue queue_;
};

/// Any template that satisfies LinkQueue: queue_under_test<MyQueue>("mine").
template <template <class> class Queue>
QueueUnderTest queue_under_test(std::string name) {
  const auto make = []<std::size_t kBytes>(std::size_t capacity) -> std::unique_ptr<AnyQueue<Message<kBytes>>> {
    return std::make_unique<QueueOf<Queue<Message<kBytes>>, Message<kBytes>>>(capacity);
  };
  QueueUnderTest out;
  out.name = std::move(name);
  out.producers = Queue<Message<kSmall>>::kProducers;
  out.consumers = Queue<Message<kSmall>>::kConsumers;
  out.make_small = [make](std::size_t capacity) { return make.template operator()<kSmall>(capacity); };
  out.make_line = [make](std::size_t capacity) { return make.template operator()<kLine>(capacity); };
  out.make_packet = [make](std::size_t capacity) { return make.template operator()<kPacket>(capacity); };
  return out;
}

/// A design that a configuration can name.
QueueUnderTest named_queue(QueueKind kind);

}  // namespace carousel::ringbus::stress
