// Every queue that a link can be made of passes the same tests.
#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <deque>
#include <numeric>
#include <random>
#include <thread>
#include <type_traits>
#include <vector>

#include <gtest/gtest.h>

#include "core/system/error.h"
#include "ringbus/native/links/link.h"
#include "ringbus/queues/queue_types.h"

namespace carousel::ringbus {
namespace {

template <class Q>
class Queue : public testing::Test {};

// ThreadSanitizer sees nothing of Debian's TBB, which is not instrumented, and does not model moodycamel's atomic
// fences.
#ifdef __SANITIZE_THREAD__
using Kinds = testing::Types<SpscRing<std::uint64_t>, MutexQueue<std::uint64_t>, MpmcRing<std::uint64_t>,
                             AtomicQueue<std::uint64_t>, BoostSpscQueue<std::uint64_t>>;
constexpr std::uint64_t kThreaded = 20000;
#else
using Kinds = testing::Types<SpscRing<std::uint64_t>, MutexQueue<std::uint64_t>, MpmcRing<std::uint64_t>,
                             AtomicQueue<std::uint64_t>, BoostSpscQueue<std::uint64_t>, TbbBoundedQueue<std::uint64_t>,
                             MoodycamelQueue<std::uint64_t>>;
constexpr std::uint64_t kThreaded = 50000;
#endif
TYPED_TEST_SUITE(Queue, Kinds);

TYPED_TEST(Queue, SatisfiesTheConcept) {
  static_assert(LinkQueue<TypeParam, std::uint64_t>);
  EXPECT_EQ(TypeParam(5).capacity(), 5u);
}

TYPED_TEST(Queue, RefusesWhenFullAndWhenEmpty) {
  for (const std::size_t capacity : {1u, 2u, 3u, 8u}) {
    TypeParam queue(capacity);
    std::uint64_t value = 77;
    for (int round = 0; round < 5; ++round) {  // again after the indices have gone round
      EXPECT_FALSE(queue.try_pop(value));
      EXPECT_EQ(value, 77u);
      for (std::uint64_t i = 0; i < capacity; ++i) {
        EXPECT_EQ(queue.free_places(), capacity - i);
        EXPECT_TRUE(queue.try_push(i));
      }
      EXPECT_EQ(queue.free_places(), 0u);
      EXPECT_FALSE(queue.try_push(99));
      for (std::uint64_t i = 0; i < capacity; ++i) {
        EXPECT_TRUE(queue.try_pop(value));
        EXPECT_EQ(value, i);
      }
      value = 77;
    }
  }
}

TYPED_TEST(Queue, BatchesTakeThePrefixThatFits) {
  for (const std::size_t capacity : {1u, 3u, 4u, 7u}) {
    TypeParam queue(capacity);
    std::vector<std::uint64_t> in(10), out(10);
    std::iota(in.begin(), in.end(), 100);
    for (int round = 0; round < 4; ++round) {
      EXPECT_EQ(queue.try_push_n(in), capacity);
      EXPECT_EQ(queue.try_push_n(in), 0u);
      EXPECT_EQ(queue.try_pop_n(std::span(out).first(1)), 1u);
      EXPECT_EQ(out[0], 100u);
      EXPECT_EQ(queue.try_push_n(std::span(in).subspan(5, 3)), 1u);
      EXPECT_EQ(queue.try_pop_n(out), capacity);
      for (std::size_t i = 0; i + 1 < capacity; ++i) EXPECT_EQ(out[i], 101 + i);
      EXPECT_EQ(out[capacity - 1], 105u);
      EXPECT_EQ(queue.try_pop_n(out), 0u);
      EXPECT_EQ(queue.try_push_n(std::span<const std::uint64_t>{}), 0u);
      EXPECT_EQ(queue.try_pop_n(std::span<std::uint64_t>{}), 0u);
    }
  }
}

TYPED_TEST(Queue, BehavesAsADequeUnderRandomCalls) {
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::minstd_rand random(seed);
    const std::size_t capacity = 1 + random() % 9;
    TypeParam queue(capacity);
    std::deque<std::uint64_t> model;
    std::uint64_t next = 0;
    std::array<std::uint64_t, 6> batch{};
    for (int i = 0; i < 3000; ++i) {
      const std::size_t n = random() % 6;
      if (random() % 2) {
        for (std::size_t k = 0; k < n; ++k) batch[k] = next + k;
        const std::size_t pushed = queue.try_push_n(std::span(batch).first(n));
        ASSERT_EQ(pushed, std::min(n, capacity - model.size()));
        for (std::size_t k = 0; k < pushed; ++k) model.push_back(next++);
      } else {
        const std::size_t popped = queue.try_pop_n(std::span(batch).first(n));
        ASSERT_EQ(popped, std::min(n, model.size()));
        for (std::size_t k = 0; k < popped; ++k, model.pop_front()) ASSERT_EQ(batch[k], model.front());
      }
      ASSERT_EQ(queue.free_places(), capacity - model.size());
    }
  }
}

// Two threads: nothing is lost or doubled, the order is kept, and the consumer sees what the producer wrote before.
TYPED_TEST(Queue, ConservesBetweenTwoThreads) {
  constexpr std::uint64_t kValues = kThreaded;
  for (const std::size_t capacity : {1u, 2u, 3u, 64u}) {
    TypeParam queue(capacity);
    std::vector<std::uint64_t> beside(kValues);  // plain memory that travels with the right to read it
    std::jthread producer([&] {
      std::minstd_rand random(1);
      std::array<std::uint64_t, 8> batch{};
      for (std::uint64_t next = 0; next < kValues;) {
        const std::size_t n = std::min<std::uint64_t>(1 + random() % 8, kValues - next);
        for (std::size_t k = 0; k < n; ++k) beside[next + k] = (next + k) * 3, batch[k] = next + k;
        const std::size_t pushed = queue.try_push_n(std::span(batch).first(n));
        if (pushed == 0) std::this_thread::yield();
        next += pushed;
      }
    });
    std::minstd_rand random(2);
    std::array<std::uint64_t, 8> batch{};
    std::uint64_t expected = 0, checksum = 0;
    bool ordered = true, seen = true;
    while (expected < kValues) {
      const std::size_t popped = queue.try_pop_n(std::span(batch).first(1 + random() % 8));
      if (popped == 0) std::this_thread::yield();
      for (std::size_t k = 0; k < popped; ++k) {
        ordered &= batch[k] == expected++;
        seen &= beside[batch[k]] == batch[k] * 3;
        checksum += batch[k];
      }
    }
    producer.join();
    EXPECT_TRUE(ordered);
    EXPECT_TRUE(seen);
    EXPECT_EQ(checksum, kValues * (kValues - 1) / 2);
    EXPECT_EQ(queue.free_places(), capacity);
  }
}

// A producer that trusts free_places() is never refused, while a consumer makes room.
TYPED_TEST(Queue, FreePlacesIsALowerBoundForTheProducer) {
  TypeParam queue(5);
  constexpr std::uint64_t kValues = 20000;
  std::jthread consumer([&] {
    std::uint64_t value;
    for (std::uint64_t got = 0; got < kValues;)
      if (queue.try_pop(value))
        ++got;
      else
        std::this_thread::yield();
  });
  std::array<std::uint64_t, 5> batch{};
  for (std::uint64_t sent = 0; sent < kValues;) {
    const std::size_t n = std::min<std::uint64_t>(queue.free_places(), kValues - sent);
    ASSERT_EQ(queue.try_push_n(std::span(batch).first(n)), n);
    sent += n;
    if (n == 0) std::this_thread::yield();
  }
}

// Two producers and two consumers, where the kind allows it: each value comes once, each producer's values come in
// order, and consumers see what a producer wrote before.
TYPED_TEST(Queue, ConservesAmongFourThreads) {
  if constexpr (TypeParam::kProducers == Parties::kMany && TypeParam::kConsumers == Parties::kMany) {
    constexpr std::uint64_t kEach = kThreaded / 4;
    for (const std::size_t capacity : {1u, 2u, 5u, 64u}) {
      TypeParam queue(capacity);
      std::vector<std::uint64_t> beside(2 * kEach);
      std::atomic<std::uint64_t> received{0};
      std::array<std::vector<std::uint64_t>, 2> got;
      {
        std::vector<std::jthread> threads;
        for (std::uint64_t p = 0; p < 2; ++p)
          threads.emplace_back([&, p] {
            std::minstd_rand random(static_cast<std::uint32_t>(p) + 1);
            std::array<std::uint64_t, 8> batch{};
            for (std::uint64_t next = 0; next < kEach;) {
              const std::size_t n = std::min<std::uint64_t>(1 + random() % 8, kEach - next);
              for (std::size_t k = 0; k < n; ++k) {
                batch[k] = p * kEach + next + k;
                beside[batch[k]] = batch[k] * 3;
              }
              const std::size_t pushed = queue.try_push_n(std::span(batch).first(n));
              if (pushed == 0) std::this_thread::yield();
              next += pushed;
            }
          });
        for (std::size_t c = 0; c < 2; ++c)
          threads.emplace_back([&, c] {
            std::minstd_rand random(static_cast<std::uint32_t>(c) + 9);
            std::array<std::uint64_t, 8> batch{};
            while (received.load() < 2 * kEach) {
              const std::size_t popped = queue.try_pop_n(std::span(batch).first(1 + random() % 8));
              if (popped == 0) std::this_thread::yield();
              received.fetch_add(popped);
              for (std::size_t k = 0; k < popped; ++k)
                got[c].push_back(beside[batch[k]] == batch[k] * 3 ? batch[k] : ~std::uint64_t{0});
            }
          });
      }
      // AtomicQueueB2 hands out tickets, and the tickets t and t + 4096 share a cell: a producer that is suspended with
      // the first is overtaken by one with the second (seen with twice as many threads as cores).
      constexpr bool kKeepsOrder = !std::is_same_v<TypeParam, AtomicQueue<std::uint64_t>>;
      std::vector<std::uint64_t> all;
      for (const std::vector<std::uint64_t>& values : got) {
        std::array<std::uint64_t, 2> next{0, 0};
        for (const std::uint64_t value : values) {
          ASSERT_LT(value, 2 * kEach) << "what the producer wrote before was not seen";
          if (kKeepsOrder) {
            ASSERT_GE(value % kEach, next[value / kEach]) << "out of order";
          }
          next[value / kEach] = value % kEach + 1;
        }
        all.insert(all.end(), values.begin(), values.end());
      }
      std::sort(all.begin(), all.end());
      ASSERT_EQ(all.size(), 2 * kEach);
      for (std::uint64_t i = 0; i < all.size(); ++i) ASSERT_EQ(all[i], i);
      EXPECT_EQ(queue.free_places(), capacity);
    }
  } else {
    GTEST_SKIP() << "made for one producer and one consumer";
  }
}

TEST(QueueKinds, AKindThatDoesNotServeSoManyIsRefusedByName) {
  EXPECT_NO_THROW(require_parties(QueueKind::kSpscRing, "topology.link.queue", Parties::kOne, Parties::kOne));
  EXPECT_NO_THROW(require_parties(QueueKind::kMpmcRing, "topology.link.queue", Parties::kMany, Parties::kMany));
  try {
    require_parties(QueueKind::kBoostSpsc, "topology.link.queue", Parties::kMany, Parties::kOne);
    FAIL() << "not refused";
  } catch (const ConfigError& error) {
    EXPECT_EQ(error.issues().at(0).key_path, "topology.link.queue");
    EXPECT_EQ(error.issues().at(0).message,
              "boost_spsc is made for one producer at a time and here are several; expected one of mpmc_ring, "
              "tbb_bounded, moodycamel, atomic_queue, mutex");
  }
}

}  // namespace
}  // namespace carousel::ringbus
