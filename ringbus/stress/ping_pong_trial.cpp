#include <array>

#include "ringbus/stress/backoff.h"
#include "ringbus/stress/delivery_checker.h"
#include "ringbus/stress/trials.h"

namespace carousel::ringbus::stress {

namespace {

/// Sends one message at a time, there and back over two queues.
template <std::size_t kBytes>
class PingPong final : public WorkerGroup {
 public:
  PingPong(const QueueUnderTest& queue, const TrialOptions& options)
      : WorkerGroup(2),
        messages_(options.messages),
        there_(queue.make<kBytes>()(options.capacity)),
        back_(queue.make<kBytes>()(options.capacity)),
        arrivals_(2, DeliveryChecker(1, options.messages)) {}

  void serve() {
    const std::int64_t begin = now_ns();
    while (served_ < messages_ && !stop_sending() && !end()) {
      const std::int64_t start = now_ns();
      if (!push(*there_, Message<kBytes>::of({0, static_cast<std::uint32_t>(served_)}), 0)) break;
      Message<kBytes> message;
      ++served_;
      if (!pop(*back_, message, 0)) break;
      round_trips_.add(static_cast<std::uint64_t>(now_ns() - start));
      (void)arrivals_[0].take(message);
      moved(0);
    }
    seconds_ = 1e-9 * static_cast<double>(now_ns() - begin);
    // Release: pairs with the acquire in answer().
    done_.store(true, std::memory_order_release);
  }

  void answer() {
    Message<kBytes> message;
    while (pop(*there_, message, 1)) {
      (void)arrivals_[1].take(message);
      moved(1);
      if (!push(*back_, message, 1)) break;
    }
  }

  TrialResult result() {
    TrialResult out;
    out.threads = 2;
    out.messages = served_;
    out.seconds = seconds_;
    out.producer_seconds = seconds_;
    out.round_trip_ns = round_trips_;
    for (const Side& side : sides_) {
      out.push_calls += side.push_calls;
      out.push_refusals += side.push_refusals;
      out.pop_calls += side.pop_calls;
      out.pop_refusals += side.pop_refusals;
    }
    const std::array<std::uint64_t, 1> sent{served_};
    for (const DeliveryChecker& one : arrivals_) out.violations += DeliveryChecker::judge({&one, 1}, sent);
    return out;
  }

 private:
  struct alignas(128) Side {
    std::uint64_t push_calls = 0, push_refusals = 0, pop_calls = 0, pop_refusals = 0;
  };

  bool push(AnyQueue<Message<kBytes>>& queue, const Message<kBytes>& message, std::size_t side) {
    Backoff backoff;
    for (++sides_[side].push_calls; !queue.try_push(message); ++sides_[side].push_calls) {
      ++sides_[side].push_refusals;
      if (end()) return false;
      backoff.wait();
    }
    return true;
  }
  bool pop(AnyQueue<Message<kBytes>>& queue, Message<kBytes>& message, std::size_t side) {
    Backoff backoff;
    for (++sides_[side].pop_calls; !queue.try_pop(message); ++sides_[side].pop_calls) {
      ++sides_[side].pop_refusals;
      // Acquire: pairs with the release in serve().
      if (end() || (side == 1 && done_.load(std::memory_order_acquire))) return false;
      backoff.wait();
    }
    return true;
  }

  std::uint64_t messages_;
  std::unique_ptr<AnyQueue<Message<kBytes>>> there_, back_;
  std::vector<DeliveryChecker> arrivals_;  // [0]: at the sender; [1]: at the other end
  std::array<Side, 2> sides_;
  alignas(128) std::uint64_t served_ = 0;  // written by serve(), with the two members below
  double seconds_ = 0;
  LatencyHistogram round_trips_;
  alignas(128) std::atomic<bool> done_{false};
};

}  // namespace

template <std::size_t kBytes>
TrialResult run_ping_pong(const QueueUnderTest& queue, const TrialOptions& options) {
  const auto game = std::make_shared<PingPong<kBytes>>(queue, options);
  const WorkerGroup::Ending ending =
      WorkerGroup::run(game, {[g = game.get()] { g->serve(); }, [g = game.get()] { g->answer(); }},
                       {options.time, options.stuck_after, options.stop});
  TrialResult out;
  if (ending != WorkerGroup::Ending::kNeverReturned) out = game->result();
  note_ending(out.violations, ending, options);
  return out;
}

template TrialResult run_ping_pong<kSmall>(const QueueUnderTest&, const TrialOptions&);
template TrialResult run_ping_pong<kLine>(const QueueUnderTest&, const TrialOptions&);
template TrialResult run_ping_pong<kPacket>(const QueueUnderTest&, const TrialOptions&);

}  // namespace carousel::ringbus::stress
