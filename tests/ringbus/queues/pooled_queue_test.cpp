// Queues that hand rays over in pieces, with every design.
#include "ringbus/queues/pooled_queue.h"

#include <atomic>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "tests/ringbus/queues/queue_kinds.h"

namespace carousel::ringbus {
namespace {

using Piece = std::vector<std::uint32_t>;

TEST(PooledQueue, HasItsPlacesAndNoMoreAndCountsThem) {
  for (const QueueKind kind : queue_kinds()) {
    SCOPED_TRACE(enum_name(kind));
    PooledQueue<Piece> queue(kind, 3);
    std::vector<Piece*> taken;
    for (int i = 0; i < 3; ++i) taken.push_back(queue.try_take());
    EXPECT_EQ(queue.try_take(), nullptr);
    EXPECT_EQ(queue.try_pop(), nullptr);  // nothing has been pushed
    queue.push(taken[0], 5);
    queue.push(taken[1], 7);
    Piece* const first = queue.try_pop();
    EXPECT_EQ(first, taken[0]);
    EXPECT_EQ(queue.try_take(), nullptr);  // a consumer has it
    queue.give_back(first);
    EXPECT_EQ(queue.try_take(), first);
    queue.push(taken[2], 1);
    const QueueUse use = queue.use();
    EXPECT_EQ(use.places, 3u);
    EXPECT_EQ(use.sent, 3u);
    EXPECT_EQ(use.rays, 13u);
    EXPECT_EQ(use.refusals, 2u);
    EXPECT_EQ(use.waiting_sum, 1u + 2 + 2);
    EXPECT_EQ(use.waiting_most, 2u);
  }
}

// Threads on both sides, with fewer pieces than threads and with more: whatever goes in comes out once and whole.
TEST(PooledQueue, LosesDoublesAndTearsNothing) {
  constexpr std::uint32_t kProducers = 3, kConsumers = 2, kEach = 3000;
  for (const QueueKind kind : many_to_many_kinds()) {
    for (const std::size_t places : {1, 2, 8}) {
      SCOPED_TRACE(testing::Message() << enum_name(kind) << " of " << places);
      PooledQueue<Piece> queue(kind, places);
      std::vector<Piece> got(kConsumers);
      std::atomic<std::uint32_t> torn{0}, received{0};
      {
        std::vector<std::jthread> threads;
        for (std::uint32_t p = 0; p < kProducers; ++p)
          threads.emplace_back([&, p] {
            for (std::uint32_t i = 0; i < kEach; ++i) {
              Piece* piece;
              while ((piece = queue.try_take()) == nullptr) std::this_thread::yield();
              if (!piece->empty()) ++torn;
              piece->assign(1 + i % 5, p * kEach + i);
              queue.push(piece, piece->size());
            }
          });
        for (std::uint32_t c = 0; c < kConsumers; ++c)
          threads.emplace_back([&, c] {
            while (received.load() < kProducers * kEach) {
              Piece* const piece = queue.try_pop();
              if (piece == nullptr) {
                std::this_thread::yield();
                continue;
              }
              const std::uint32_t value = piece->front();
              if (*piece != Piece(1 + value % kEach % 5, value)) ++torn;
              got[c].push_back(value);
              piece->clear();
              queue.give_back(piece);
              ++received;
            }
          });
      }
      EXPECT_EQ(torn, 0u);
      Piece all;
      for (const Piece& values : got) all.insert(all.end(), values.begin(), values.end());
      std::sort(all.begin(), all.end());
      ASSERT_EQ(all.size(), kProducers * kEach);
      for (std::uint32_t i = 0; i < all.size(); ++i) ASSERT_EQ(all[i], i);
      const QueueUse use = queue.use();
      EXPECT_EQ(use.sent, kProducers * kEach);
      EXPECT_EQ(use.rays, kProducers * kEach * 3);
      EXPECT_GE(use.waiting_most, 1u);
      EXPECT_LE(use.waiting_most, places);
    }
  }
}

}  // namespace
}  // namespace carousel::ringbus
