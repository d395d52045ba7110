// Compares all queues in one process: two pinned threads, and two producers with two consumers. Run with
// --benchmark_enable_random_interleaving=true --benchmark_repetitions=20, so that noise affects all of them.
#include <array>
#include <atomic>
#include <barrier>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include <benchmark/benchmark.h>
#include <sched.h>

#include "bench/queues/queue_benchmarks.h"
#include "bench/queues/queue_peers.h"
#include "ringbus/queues/queue_types.h"
#include "ringbus/stress/backoff.h"

namespace carousel::bench {

namespace {

using ringbus::stress::Backoff;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kMessages = 1 << 17;
constexpr std::size_t kRoundTrips = 1 << 13;
constexpr std::size_t kMostBatch = 32;

template <std::size_t kBytes>
struct Message {
  std::uint64_t number = 0;
  std::array<std::byte, kBytes - sizeof(number)> rest{};
};
template <>
struct Message<8> {
  std::uint64_t number = 0;
};

void stay_on_core(std::size_t thread) {
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(thread % std::max(1u, std::thread::hardware_concurrency()), &set);
  (void)sched_setaffinity(0, sizeof set, &set);
}

/// Starts the bodies together, a core each in turn; seconds until the last has ended.
double timed(const std::vector<std::function<void()>>& bodies) {
  std::barrier start(static_cast<std::ptrdiff_t>(bodies.size()) + 1);
  Clock::time_point begin;
  {
    std::vector<std::jthread> threads;
    for (std::size_t t = 0; t < bodies.size(); ++t)
      threads.emplace_back([&, t] {
        stay_on_core(t);
        start.arrive_and_wait();
        bodies[t]();
      });
    begin = Clock::now();
    start.arrive_and_wait();
  }
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

template <class Queue, class T>
void send(Queue& queue, std::size_t messages, std::size_t batch) {
  std::array<T, kMostBatch> values;
  Backoff backoff;
  for (std::size_t sent = 0; sent < messages;) {
    std::size_t count;
    if (batch == 1) {
      values[0].number = sent;
      count = queue.try_push(values[0]);
    } else {
      const std::size_t want = std::min(batch, messages - sent);
      for (std::size_t i = 0; i < want; ++i) values[i].number = sent + i;
      count = queue.try_push_n(std::span(values).first(want));
    }
    sent += count;
    if (count == 0)
      backoff.wait();
    else
      backoff.reset();
  }
}

/// Takes messages until `left` of all consumers together are gone; the sum of their numbers.
template <class Queue, class T>
std::uint64_t take(Queue& queue, std::size_t messages, std::size_t batch) {
  std::array<T, kMostBatch> values;
  Backoff backoff;
  std::uint64_t sum = 0;
  for (std::size_t got = 0; got < messages;) {
    const std::size_t count = batch == 1 ? queue.try_pop(values[0])
                                         : queue.try_pop_n(std::span(values).first(std::min(batch, messages - got)));
    for (std::size_t i = 0; i < count; ++i) sum += values[i].number;
    got += count;
    if (count == 0)
      backoff.wait();
    else
      backoff.reset();
  }
  return sum;
}

template <template <class> class Queue, std::size_t kBytes>
void stream(benchmark::State& state, std::size_t pairs) {
  using T = Message<kBytes>;
  const auto depth = static_cast<std::size_t>(state.range(0)), batch = static_cast<std::size_t>(state.range(1));
  const std::size_t each = kMessages / pairs;
  for (auto _ : state) {
    Queue<T> queue(depth);
    std::vector<std::uint64_t> sums(pairs);
    std::vector<std::function<void()>> bodies;
    for (std::size_t p = 0; p < pairs; ++p) {
      bodies.push_back([&] { send<Queue<T>, T>(queue, each, batch); });
      bodies.push_back([&, p] { sums[p] = take<Queue<T>, T>(queue, each, batch); });
    }
    state.SetIterationTime(timed(bodies));
    std::uint64_t sum = 0;
    for (const std::uint64_t one : sums) sum += one;
    if (sum != pairs * each * (each - 1) / 2) state.SkipWithError("messages were lost or doubled");
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kMessages));
}

/// Items are round trips.
template <template <class> class Queue, std::size_t kBytes>
void ping_pong(benchmark::State& state) {
  using T = Message<kBytes>;
  const auto hand = [](Queue<T>& from, Queue<T>& to, bool serves) {
    T message{};
    Backoff backoff;
    for (std::size_t i = 0; i < kRoundTrips; ++i) {
      if (serves)
        while (!to.try_push(message)) backoff.wait();
      backoff.reset();
      while (!from.try_pop(message)) backoff.wait();
      backoff.reset();
      if (!serves)
        while (!to.try_push(message)) backoff.wait();
    }
  };
  for (auto _ : state) {
    Queue<T> there(64), back(64);
    state.SetIterationTime(timed({[&] { hand(back, there, true); }, [&] { hand(there, back, false); }}));
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kRoundTrips));
}

template <template <class> class Queue, std::size_t kBytes>
void enter(const std::string& name) {
  const std::string size = "/" + std::to_string(kBytes) + "B";
  benchmark::RegisterBenchmark(("1p1c/" + name + size).c_str(),
                               [](benchmark::State& s) { stream<Queue, kBytes>(s, 1); })
      ->ArgNames({"depth", "batch"})
      ->Args({1024, 1})
      ->Args({1024, 32})
      ->UseManualTime();
  benchmark::RegisterBenchmark(("ping_pong/" + name + size).c_str(), ping_pong<Queue, kBytes>)->UseManualTime();
  if constexpr (Queue<Message<kBytes>>::kProducers == Parties::kMany)
    benchmark::RegisterBenchmark(("2p2c/" + name + size).c_str(),
                                 [](benchmark::State& s) { stream<Queue, kBytes>(s, 2); })
        ->ArgNames({"depth", "batch"})
        ->Args({1024, 1})
        ->Args({1024, 32})
        ->UseManualTime();
}

template <template <class> class Queue>
void enter(const std::string& name) {
  enter<Queue, 8>(name);
  enter<Queue, 64>(name);
}

}  // namespace

}  // namespace carousel::bench

int main(int argc, char** argv) {
  using namespace carousel;
  bench::enter<ringbus::SpscRing>("spsc_ring");
  bench::enter<ringbus::MpmcRing>("mpmc_ring");
  bench::enter<ringbus::TbbBoundedQueue>("tbb_bounded");
  bench::enter<ringbus::MoodycamelQueue>("moodycamel");
  bench::enter<ringbus::AtomicQueue>("atomic_queue");
  bench::enter<ringbus::BoostSpscQueue>("boost_spsc");
  bench::enter<ringbus::MutexQueue>("mutex");
  bench::enter<bench::AtomicQueueSpsc>("peer_atomic_queue_spsc");
  bench::enter<bench::AtomicQueueMpmc>("peer_atomic_queue");
  bench::enter<bench::ReaderWriterQueue>("peer_reader_writer_queue");
  bench::enter<bench::CircularBuffer>("peer_circular_buffer");
  bench::enter_ring_queues();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}
