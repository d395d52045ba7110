#include "ringbus/time/channel.h"

#include <algorithm>
#include <deque>
#include <random>
#include <stdexcept>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "tests/ringbus/time/loose_channel.h"

namespace carousel::ringbus {
namespace {

struct Sent {
  Cycle arrival = 0;
  int number = 0;
};

/// How many are on the way rises and falls, so that blocks are put in and taken out again.
bool sends_next(std::mt19937& random, int step) {
  return random() % 8 < (step / 500 % 2 == 0 ? 5u : 2u);
}

TEST(Channel, IsAQueueWhateverItsLength) {
  std::mt19937 random(1);
  LooseChannel<int> channel;
  std::deque<Sent> expected;
  Cycle last = 0;
  std::size_t most = 0;
  for (int step = 0, number = 0; step < 20'000; ++step) {
    if (sends_next(random, step)) {
      last += random() % 3;
      channel.send(last, number);
      expected.push_back({last, number++});
    } else if (!expected.empty()) {
      ASSERT_EQ(channel.front(), expected.front().number);
      ASSERT_EQ(channel.take(), expected.front().number);
      expected.pop_front();
    }
    most = std::max(most, expected.size());
    ASSERT_EQ(channel.size(), expected.size());
    ASSERT_EQ(channel.next(), expected.empty() ? kNever : expected.front().arrival);
    if (!expected.empty() && step % 7 == 0) {
      const std::size_t place = random() % expected.size();
      ASSERT_EQ(channel.peek(place), expected[place].number);
      const Cycle now = expected[place].arrival;
      const auto later = std::find_if(expected.begin(), expected.end(), [&](const Sent& s) { return s.arrival > now; });
      ASSERT_EQ(channel.arrived(now), static_cast<std::size_t>(later - expected.begin()));
      ASSERT_EQ(channel.next_after(now), later == expected.end() ? kNever : later->arrival);
    }
  }
  EXPECT_GT(most, 100u);  // many blocks
}

TEST(Channel, BringsForwardAcrossBlocks) {
  LooseChannel<int> channel;
  for (int i = 0; i < 40; ++i) channel.send(static_cast<Cycle>(i), i);
  channel.bring_forward(35);
  EXPECT_EQ(channel.next(), 35u);
  EXPECT_EQ(channel.take(), 35);
  for (int i = 0; i < 40; ++i)
    if (i != 35) {
      EXPECT_EQ(channel.take(), i);
    }
  EXPECT_EQ(channel.next(), kNever);
}

// The sender learns of as many places by each cycle as the receiver has given back for that cycle.
TEST(Channel, PlacesComeBackWhenTheReceiverSays) {
  std::mt19937 random(2);
  LooseChannel<int, true> channel;
  std::deque<Cycle> expected;
  Cycle now = 0;
  std::size_t waiting = 0;
  for (int step = 0, sent = 0, taken = 0; step < 20'000; ++step) {
    now += random() % 2;
    if (sends_next(random, step)) {
      channel.send(now, sent++);
      ++waiting;
    } else if (waiting > 0) {
      ASSERT_EQ(channel.take(now + 9), taken++);
      expected.push_back(now + 9);
      --waiting;
    }
    ASSERT_EQ(channel.next_return(), expected.empty() ? kNever : expected.front());
    if (step % 3 > 0) continue;
    std::uint32_t back = 0;
    for (; !expected.empty() && expected.front() <= now; expected.pop_front()) ++back;
    ASSERT_EQ(channel.take_returns(now), back);
  }
  EXPECT_GT(expected.size(), 0u);
}

TEST(Channel, PlacesComeBackInOrder) {
  if (!kChecked) GTEST_SKIP() << "only checked builds look";
  LooseChannel<int, true> channel;
  for (int i = 0; i < 2; ++i) channel.send(0, i);
  channel.take(5);
  EXPECT_THROW(channel.take(4), std::logic_error);
}

// Sender and receiver on two threads, which read what the other publishes.
TEST(Channel, ServesTwoThreads) {
  constexpr int kThings = 100'000;
  LooseChannel<std::vector<int>, true> channel;
  std::thread receiver([&] {
    for (int i = 0; i < kThings;) {
      if (channel.next() == kNever) continue;
      EXPECT_EQ(channel.take(static_cast<Cycle>(i)), std::vector<int>{i});
      ++i;
    }
  });
  std::size_t back = 0;
  for (int i = 0; i < kThings; ++i) {
    channel.send(static_cast<Cycle>(i), {i});
    if (i % 5 == 0) back += channel.take_returns(kNever - 1);
  }
  receiver.join();
  EXPECT_EQ(back + channel.take_returns(kNever - 1), static_cast<std::size_t>(kThings));
}

}  // namespace
}  // namespace carousel::ringbus
