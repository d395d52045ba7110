#include <algorithm>
#include <array>
#include <deque>
#include <thread>

#include "ringbus/stress/backoff.h"
#include "ringbus/stress/delivery_checker.h"
#include "ringbus/stress/trials.h"

namespace carousel::ringbus::stress {

namespace {

constexpr std::size_t kNodes = 4;
constexpr std::size_t kTaken = 8;  // messages taken from a link at once, at most

/// A ring like the native engine's. Each node receives messages, passes on those of other nodes, and sends its own, of
/// which at most `capacity` are out at once, so that a place on the ring stays free.
template <std::size_t kBytes>
class Ring final : public WorkerGroup {
 public:
  Ring(const QueueUnderTest& queue, std::size_t threads, const TrialOptions& options)
      : WorkerGroup(threads),
        threads_(threads),
        each_(std::max<std::uint64_t>(options.messages / kNodes, 1)),
        capacity_(options.capacity) {
    for (std::size_t n = 0; n < kNodes; ++n) {
      nodes_.emplace_back(Node{});
      nodes_.back().arrivals = DeliveryChecker(kNodes, each_);
      nodes_.back().sent_at.resize(capacity_);
      links_.push_back(queue.make<kBytes>()(capacity_));
    }
  }

  /// Thread `t` plays every threads-th node.
  void play(std::size_t t) {
    Backoff backoff;
    if (t == 0) begin_ = now_ns();
    while (!end() && home_.load(std::memory_order_acquire) < kNodes) {
      bool any = false;
      for (std::size_t n = t; n < kNodes; n += threads_) any |= step(n);
      if (any) {
        moved(t);
        backoff.reset();
      } else {
        backoff.wait();
      }
    }
    if (t == 0) finish_ = now_ns();
  }

  TrialResult result() {
    TrialResult out;
    out.threads = threads_;
    out.seconds = 1e-9 * static_cast<double>(finish_ - begin_);
    out.producer_seconds = out.seconds * kNodes;
    std::vector<std::uint64_t> sent;
    for (const Node& node : nodes_) sent.push_back(node.sent);
    for (const Node& node : nodes_) {
      out.messages += node.sent;
      out.push_calls += node.push_calls;
      out.push_refusals += node.push_refusals;
      out.pop_calls += node.pop_calls;
      out.pop_refusals += node.pop_refusals;
      out.round_trip_ns.add(node.round_trips);
      // Every node sees every message once.
      out.violations += DeliveryChecker::judge({&node.arrivals, 1}, sent);
    }
    return out;
  }

 private:
  struct alignas(128) Node {
    std::uint64_t sent = 0, home = 0;
    bool finished = false;
    std::deque<Message<kBytes>> egress;
    std::vector<std::int64_t> sent_at;  // send times of the messages that are out, by number modulo capacity
    DeliveryChecker arrivals{0, 0};
    LatencyHistogram round_trips;
    std::uint64_t push_calls = 0, push_refusals = 0, pop_calls = 0, pop_refusals = 0;
  };

  bool step(std::size_t n) {
    Node& node = nodes_[n];
    bool any = send(node, *links_[n]);
    if (node.egress.empty()) any |= receive(node, n);
    while (node.egress.empty() && node.sent < each_ && node.sent - node.home < capacity_ && !stop_sending()) {
      node.sent_at[node.sent % capacity_] = now_ns();
      node.egress.push_back(
          Message<kBytes>::of({static_cast<std::uint32_t>(n), static_cast<std::uint32_t>(node.sent++)}));
      any |= send(node, *links_[n]);
    }
    if (!node.finished && node.home == node.sent && (node.sent == each_ || stop_sending())) {
      node.finished = true;
      // Release: pairs with the acquire in play().
      home_.fetch_add(1, std::memory_order_release);
    }
    return any;
  }

  bool send(Node& node, AnyQueue<Message<kBytes>>& link) {
    bool any = false;
    while (!node.egress.empty()) {
      ++node.push_calls;
      if (!link.try_push(node.egress.front())) {
        ++node.push_refusals;
        break;
      }
      node.egress.pop_front();
      any = true;
    }
    return any;
  }

  bool receive(Node& node, std::size_t n) {
    std::array<Message<kBytes>, kTaken> batch;
    const std::size_t count =
        links_[(n + kNodes - 1) % kNodes]->try_pop_n(std::span(batch).first(std::min(kTaken, capacity_)));
    ++node.pop_calls;
    node.pop_refusals += count == 0;
    for (std::size_t k = 0; k < count; ++k) {
      const std::optional<Origin> origin = node.arrivals.take(batch[k]);
      if (!origin || origin->producer != n) {
        node.egress.push_back(batch[k]);
        continue;
      }
      ++node.home;
      node.round_trips.add(
          static_cast<std::uint64_t>(std::max<std::int64_t>(now_ns() - node.sent_at[origin->number % capacity_], 0)));
    }
    return count > 0;
  }

  std::size_t threads_;
  std::uint64_t each_;
  std::size_t capacity_;
  std::deque<Node> nodes_;
  std::vector<std::unique_ptr<AnyQueue<Message<kBytes>>>> links_;  // from node n to the next
  std::int64_t begin_ = 0, finish_ = 0;
  std::atomic<std::size_t> home_{0};  // nodes that have all of their messages back
};

}  // namespace

template <std::size_t kBytes>
TrialResult run_circulation(const QueueUnderTest& queue, const TrialOptions& options) {
  const std::size_t threads = std::clamp<std::size_t>(std::thread::hardware_concurrency(), 1, kNodes);
  const auto ring = std::make_shared<Ring<kBytes>>(queue, threads, options);
  std::vector<std::function<void()>> bodies;
  for (std::size_t t = 0; t < threads; ++t) bodies.push_back([r = ring.get(), t] { r->play(t); });
  const WorkerGroup::Ending ending = WorkerGroup::run(ring, bodies, {options.time, options.stuck_after, options.stop});
  TrialResult out;
  if (ending != WorkerGroup::Ending::kNeverReturned) out = ring->result();
  note_ending(out.violations, ending, options);
  return out;
}

template TrialResult run_circulation<kSmall>(const QueueUnderTest&, const TrialOptions&);
template TrialResult run_circulation<kLine>(const QueueUnderTest&, const TrialOptions&);
template TrialResult run_circulation<kPacket>(const QueueUnderTest&, const TrialOptions&);

}  // namespace carousel::ringbus::stress
