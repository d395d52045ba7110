// The three link queues between two threads: what one message costs when both sides are busy.
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <span>
#include <thread>

#include <benchmark/benchmark.h>

#include "ringbus/queues/mutex_queue.h"
#include "ringbus/queues/spsc_ring.h"
#include "ringbus/queues/tbb_bounded_queue.h"

namespace carousel::bench {

namespace {

constexpr std::size_t kMessages = 1 << 18;
constexpr std::size_t kMostBatch = 32;

/// A message of a size; the number tells whether all arrive, in order.
template <std::size_t kBytes>
struct Message {
  std::uint64_t number = 0;
  std::array<std::byte, kBytes - sizeof(number)> rest{};
};
template <>
struct Message<8> {
  std::uint64_t number = 0;
};

/// Takes all messages from the queue; false when one is lost or out of order.
template <class Queue, class T>
bool drain(Queue& queue, std::size_t batch) {
  std::array<T, kMostBatch> values;
  for (std::size_t received = 0; received < kMessages;) {
    const std::size_t count = queue.try_pop_n(std::span(values).first(batch));
    for (std::size_t i = 0; i < count; ++i)
      if (values[i].number != received + i) return false;
    received += count;
    if (count == 0) std::this_thread::yield();  // with one core for both, the other side must get on
  }
  return true;
}

template <class Queue, class T>
void fill(Queue& queue, std::size_t batch) {
  std::array<T, kMostBatch> values;
  for (std::size_t sent = 0; sent < kMessages;) {
    for (std::size_t i = 0; i < batch; ++i) values[i].number = sent + i;
    const std::size_t want = std::min(batch, kMessages - sent);
    const std::size_t count = queue.try_push_n(std::span(values).first(want));
    sent += count;
    if (count == 0) std::this_thread::yield();
  }
}

/// Items are messages. The arguments are the queue's depth and how many messages go in one call.
template <template <class> class Queue, std::size_t kBytes>
void two_threads(benchmark::State& state) {
  using T = Message<kBytes>;
  const auto depth = static_cast<std::size_t>(state.range(0)),
             batch = static_cast<std::size_t>(state.range(1));
  for (auto _ : state) {
    Queue<T> queue(depth);
    bool in_order = true;
    {
      const std::jthread consumer([&] { in_order = drain<Queue<T>, T>(queue, batch); });
      fill<Queue<T>, T>(queue, batch);
    }
    if (!in_order) state.SkipWithError("a message was lost or came out of order");
  }
  state.SetItemsProcessed(state.iterations() * static_cast<std::int64_t>(kMessages));
}

void shapes(benchmark::internal::Benchmark* benchmark) {
  benchmark->ArgNames({"depth", "batch"})->Args({1024, 1})->Args({1024, 32})->Args({16, 8})->UseRealTime();
}
BENCHMARK_TEMPLATE(two_threads, ringbus::SpscRing, 8)->Apply(shapes);
BENCHMARK_TEMPLATE(two_threads, ringbus::SpscRing, 64)->Apply(shapes);
BENCHMARK_TEMPLATE(two_threads, ringbus::TbbBoundedQueue, 8)->Apply(shapes);
BENCHMARK_TEMPLATE(two_threads, ringbus::TbbBoundedQueue, 64)->Apply(shapes);
BENCHMARK_TEMPLATE(two_threads, ringbus::MutexQueue, 8)->Apply(shapes);
BENCHMARK_TEMPLATE(two_threads, ringbus::MutexQueue, 64)->Apply(shapes);

}  // namespace

}  // namespace carousel::bench
