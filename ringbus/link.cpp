#include "ringbus/link.h"

#include "core/error.h"
#include "ringbus/mutex_queue.h"
#include "ringbus/spsc_ring.h"
#include "ringbus/tbb_bounded_queue.h"

namespace carousel::ringbus {

namespace {

template <class Queue>
class QueueLink final : public Link {
  static_assert(LinkQueue<Queue, PacketId>);

 public:
  QueueLink(std::size_t depth, ResourceId from, ResourceId to) : Link(from, to), queue_(depth) {}
  std::size_t try_receive(std::span<PacketId> packets) override { return queue_.try_pop_n(packets); }
  std::size_t free_places() override { return queue_.free_places(); }
  std::size_t capacity() const override { return queue_.capacity(); }

 private:
  std::size_t push(std::span<const PacketId> packets) override { return queue_.try_push_n(packets); }
  Queue queue_;
};

}  // namespace

std::unique_ptr<Link> make_link(QueueKind kind, std::size_t depth, ResourceId from, ResourceId to) {
  switch (kind) {
    case QueueKind::kSpscRing: return std::make_unique<QueueLink<SpscRing<PacketId>>>(depth, from, to);
    case QueueKind::kTbbBounded: return std::make_unique<QueueLink<TbbBoundedQueue<PacketId>>>(depth, from, to);
    case QueueKind::kMutex: return std::make_unique<QueueLink<MutexQueue<PacketId>>>(depth, from, to);
  }
  throw SimulationError("no such queue kind");
}

}  // namespace carousel::ringbus
