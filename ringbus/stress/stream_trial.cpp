#include <algorithm>
#include <array>
#include <random>
#include <thread>

#include "ringbus/stress/backoff.h"
#include "ringbus/stress/single_thread_check.h"
#include "ringbus/stress/trials.h"

namespace carousel::ringbus::stress {

namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;

constexpr std::size_t kBatch = 32;
constexpr std::uint64_t kStampEvery = 16, kStamps = 4096;

struct Plan {
  std::size_t producers = 1, consumers = 1;
  std::size_t capacity = 64, batch = 1;
  bool random = false;            // lengths of batches; yields and sleeps
  nanoseconds push_pause{0};      // after each batch
  nanoseconds pop_pause{0};       // after each call that was not refused
  std::uint64_t stall_every = 0;  // messages that the consumer takes between two stops
};

Plan plan_of(const TrialOptions& options) {
  Plan plan;
  plan.capacity = options.capacity;
  const std::size_t cores = std::max(1u, std::thread::hardware_concurrency());
  switch (options.pattern) {
    case Pattern::kBatches:
      plan.batch = kBatch;
      break;
    case Pattern::kBurst:
      plan.batch = kBatch;
      plan.push_pause = microseconds(10);
      break;
    case Pattern::kHotspot:
      plan.producers = 4;
      break;
    case Pattern::kManyToMany:
      plan.producers = plan.consumers = 2;
      break;
    case Pattern::kSlowConsumer:
      plan.pop_pause = microseconds(2);
      break;
    case Pattern::kStalledConsumer:
      plan.stall_every = std::max<std::uint64_t>(options.messages / 8, 1);
      break;
    case Pattern::kOversubscribed:
      plan.producers = plan.consumers = 2 * std::min<std::size_t>(cores, 16);
      break;
    case Pattern::kCapacity1:
      plan.capacity = 1;
      break;
    case Pattern::kCapacity2:
      plan.capacity = 2;
      break;
    case Pattern::kRandomPauses:
      plan.batch = kBatch;
      plan.random = true;
      break;
    default:
      break;
  }
  return plan;
}

template <std::size_t kBytes>
class Stream final : public WorkerGroup {
 public:
  Stream(const QueueUnderTest& queue, const Plan& plan, const TrialOptions& options)
      : WorkerGroup(plan.producers + plan.consumers),
        plan_(plan),
        seed_(options.seed),
        each_(std::max<std::uint64_t>(options.messages / plan.producers, 1)),
        senders_(plan.producers),
        receivers_(plan.consumers),
        arrivals_(plan.consumers, DeliveryChecker(plan.producers, each_)) {
    // One queue for all if it serves so many, otherwise one for each producer.
    const bool shared = (plan.producers == 1 || queue.producers == Parties::kMany) &&
                        (plan.consumers == 1 || queue.consumers == Parties::kMany);
    for (std::size_t q = 0; q < (shared ? 1 : plan.producers); ++q)
      queues_.push_back(queue.make<kBytes>()(plan.capacity));
    for (Sender& sender : senders_) sender.stamps = std::vector<std::atomic<std::int64_t>>(kStamps);
  }

  void produce(std::size_t p) {
    Sender& me = senders_[p];
    AnyQueue<Message<kBytes>>& queue = *queues_[p % queues_.size()];
    std::minstd_rand random(static_cast<std::uint32_t>(seed_ * 31 + p + 1));
    std::array<Message<kBytes>, kBatch> batch;
    me.begin = now_ns();
    std::uint64_t next = 0;
    while (next < each_ && !stop_sending() && !end()) {
      const std::size_t wanted = plan_.random ? 1 + random() % plan_.batch : plan_.batch;
      const std::size_t count = static_cast<std::size_t>(std::min<std::uint64_t>(wanted, each_ - next));
      for (std::size_t k = 0; k < count; ++k)
        batch[k] = Message<kBytes>::of({static_cast<std::uint32_t>(p), static_cast<std::uint32_t>(next + k)});
      const std::size_t pushed = push_all(queue, me, p, next, std::span(batch).first(count));
      next += pushed;
      if (pushed < count) break;
      if (plan_.push_pause.count() > 0) pause_for(plan_.push_pause);
      if (plan_.random) pause_at_random(random);
    }
    if (next == each_) note_first_done();
    me.finish = now_ns();
    // Release: pairs with the acquire in consume(): a consumer that sees all producers done sees all their messages.
    producers_done_.fetch_add(1, std::memory_order_release);
  }

  void consume(std::size_t c) {
    Receiver& me = receivers_[c];
    DeliveryChecker& arrivals = arrivals_[c];
    std::minstd_rand random(static_cast<std::uint32_t>(seed_ * 37 + c + 1));
    std::array<Message<kBytes>, kBatch> batch;
    Backoff backoff;
    std::int64_t quiet_since = 0;
    std::uint64_t next_stall = plan_.stall_every;
    while (!end()) {
      bool any = false;
      for (std::size_t q = queues_.size() == 1 ? 0 : c; q < queues_.size(); q += plan_.consumers) {
        const std::size_t wanted = plan_.random ? 1 + random() % plan_.batch : plan_.batch;
        const std::size_t count =
            wanted == 1 ? queues_[q]->try_pop(batch[0]) : queues_[q]->try_pop_n(std::span(batch).first(wanted));
        ++me.calls;
        me.refusals += count == 0;
        for (std::size_t k = 0; k < count; ++k) take(me, arrivals, batch[k]);
        any |= count > 0;
      }
      if (any) {
        me.last = now_if_sampled(me, arrivals.taken());
        me.taken.store(arrivals.taken(), std::memory_order_relaxed);
        moved(plan_.producers + c);
        backoff.reset();
        quiet_since = 0;
        if (plan_.pop_pause.count() > 0) pause_for(plan_.pop_pause);
        if (plan_.stall_every > 0 && arrivals.taken() >= next_stall) {
          next_stall += plan_.stall_every;
          pause_for(milliseconds(5));
        }
        if (plan_.random) pause_at_random(random);
        continue;
      }
      // Acquire: pairs with the release in produce().
      if (producers_done_.load(std::memory_order_acquire) == plan_.producers) {
        if (all_taken()) break;
        // Another consumer may still have the missing messages; after so long they are lost.
        const std::int64_t now = now_ns();
        if (quiet_since == 0) quiet_since = now;
        if (now - quiet_since > kQuiet) break;
      }
      backoff.wait();
    }
    me.last = quiet_since != 0 ? quiet_since : now_ns();
  }

  TrialResult result() {
    TrialResult out;
    out.threads = plan_.producers + plan_.consumers;
    std::vector<std::uint64_t> sent;
    std::int64_t begin = senders_[0].begin, finish = 0;
    for (Sender& sender : senders_) {
      sent.push_back(sender.sent.load());
      out.messages += sent.back();
      out.push_calls += sender.calls;
      out.push_refusals += sender.refusals;
      out.blocked_seconds += 1e-9 * static_cast<double>(sender.blocked);
      out.producer_seconds += 1e-9 * static_cast<double>(sender.finish - sender.begin);
      begin = std::min(begin, sender.begin);
      finish = std::max(finish, sender.finish);
    }
    for (Receiver& receiver : receivers_) {
      out.pop_calls += receiver.calls;
      out.pop_refusals += receiver.refusals;
      out.transit_ns.add(receiver.transit);
      finish = std::max(finish, receiver.last);
    }
    out.seconds = 1e-9 * static_cast<double>(finish - begin);
    const std::vector<std::uint64_t>& shares = at_first_done_.empty() ? sent : at_first_done_;
    const auto [least, most] = std::minmax_element(shares.begin(), shares.end());
    out.fairness = *most == 0 ? 1 : static_cast<double>(*least) / static_cast<double>(*most);
    out.violations = DeliveryChecker::judge(arrivals_, sent);
    return out;
  }

 private:
  static constexpr std::int64_t kQuiet = 50'000'000;  // ns

  struct alignas(128) Sender {
    std::atomic<std::uint64_t> sent{0};
    std::uint64_t calls = 0, refusals = 0;
    std::int64_t blocked = 0, begin = 0, finish = 0;  // ns
    std::vector<std::atomic<std::int64_t>> stamps;    // send times of every kStampEvery-th message
  };
  struct alignas(128) Receiver {
    std::atomic<std::uint64_t> taken{0};
    std::uint64_t calls = 0, refusals = 0;
    std::int64_t last = 0;
    LatencyHistogram transit;
  };

  static std::size_t stamp_of(std::uint64_t number) { return static_cast<std::size_t>(number / kStampEvery % kStamps); }

  std::size_t push_all(AnyQueue<Message<kBytes>>& queue, Sender& me, std::size_t p, std::uint64_t first,
                       std::span<const Message<kBytes>> batch) {
    Backoff backoff;
    std::int64_t blocked_since = 0;
    std::size_t done = 0;
    while (done < batch.size() && !end()) {
      const std::uint64_t from = first + done, until = first + batch.size();
      for (std::uint64_t n = (from + kStampEvery - 1) / kStampEvery * kStampEvery; n < until; n += kStampEvery)
        // Relaxed: the queue publishes it with the message.
        me.stamps[stamp_of(n)].store(now_ns(), std::memory_order_relaxed);
      const std::size_t pushed = batch.size() == 1 ? queue.try_push(batch[0]) : queue.try_push_n(batch.subspan(done));
      ++me.calls;
      if (pushed == 0) {
        ++me.refusals;
        if (blocked_since == 0) blocked_since = now_ns();
        backoff.wait();
        continue;
      }
      if (blocked_since != 0) me.blocked += now_ns() - blocked_since;
      blocked_since = 0;
      backoff.reset();
      done += pushed;
      me.sent.store(first + done, std::memory_order_relaxed);
      moved(p);
    }
    return done;
  }

  void take(Receiver& me, DeliveryChecker& arrivals, const Message<kBytes>& message) {
    const std::optional<Origin> origin = arrivals.take(message);
    if (!origin || origin->number % kStampEvery != 0) return;
    const std::int64_t stamp =
        senders_[origin->producer].stamps[stamp_of(origin->number)].load(std::memory_order_relaxed);
    me.transit.add(static_cast<std::uint64_t>(std::max<std::int64_t>(now_ns() - stamp, 0)));
  }
  std::int64_t now_if_sampled(const Receiver& me, std::uint64_t taken) const {
    return taken % kStampEvery == 0 ? now_ns() : me.last;
  }

  void pause_at_random(std::minstd_rand& random) {
    const std::uint32_t dice = static_cast<std::uint32_t>(random() % 256);
    if (dice == 0)
      pause_for(microseconds(50 + random() % 200));
    else if (dice < 16)
      std::this_thread::yield();
  }

  bool all_taken() const {
    std::uint64_t sent = 0, taken = 0;
    for (const Sender& sender : senders_) sent += sender.sent.load(std::memory_order_relaxed);
    for (const Receiver& receiver : receivers_) taken += receiver.taken.load(std::memory_order_relaxed);
    return taken >= sent;
  }
  void note_first_done() {
    if (first_done_.exchange(true)) return;
    for (const Sender& sender : senders_) at_first_done_.push_back(sender.sent.load(std::memory_order_relaxed));
  }

  Plan plan_;
  std::uint64_t seed_, each_;
  std::vector<std::unique_ptr<AnyQueue<Message<kBytes>>>> queues_;
  std::vector<Sender> senders_;
  std::vector<Receiver> receivers_;
  std::vector<DeliveryChecker> arrivals_;
  std::atomic<std::size_t> producers_done_{0};
  std::atomic<bool> first_done_{false};
  std::vector<std::uint64_t> at_first_done_;
};

}  // namespace

template <std::size_t kBytes>
TrialResult run_stream(const QueueUnderTest& queue, const TrialOptions& options) {
  const Plan plan = plan_of(options);
  const auto stream = std::make_shared<Stream<kBytes>>(queue, plan, options);
  std::vector<std::function<void()>> bodies;
  // The threads own the trial. The bodies have a plain pointer, as the trial would otherwise own itself.
  for (std::size_t p = 0; p < plan.producers; ++p) bodies.push_back([s = stream.get(), p] { s->produce(p); });
  for (std::size_t c = 0; c < plan.consumers; ++c) bodies.push_back([s = stream.get(), c] { s->consume(c); });
  const WorkerGroup::Ending ending =
      WorkerGroup::run(stream, bodies, {options.time, options.stuck_after, options.stop});
  TrialResult out;
  if (ending != WorkerGroup::Ending::kNeverReturned) out = stream->result();
  note_ending(out.violations, ending, options);
  return out;
}

template TrialResult run_stream<kSmall>(const QueueUnderTest&, const TrialOptions&);
template TrialResult run_stream<kLine>(const QueueUnderTest&, const TrialOptions&);
template TrialResult run_stream<kPacket>(const QueueUnderTest&, const TrialOptions&);

}  // namespace carousel::ringbus::stress
