// Threads of a native run, and the heartbeat of the resource that may stop.
#include "ringbus/native/worker_threads.h"

#include <array>
#include <chrono>
#include <functional>
#include <stdexcept>

#include <gtest/gtest.h>

#include "ringbus/native/heartbeat_monitor.h"

namespace carousel::ringbus {
namespace {

using namespace std::chrono_literals;

TEST(WorkerThreads, EachPlaysOnceAndMayPlayAgain) {
  WorkerThreads threads(3);
  std::array<int, 3> played{};
  for (int round = 1; round <= 2; ++round) {
    threads.run([&](std::size_t t) { ++played[t]; }, [&] { threads.watch(1ms, [] {}); });
    EXPECT_EQ(played, (std::array{round, round, round}));
  }
  EXPECT_EQ(threads.error(), nullptr);
}

TEST(WorkerThreads, EndWhenTheWatcherAsks) {
  WorkerThreads threads(2);
  std::uint64_t seen = 0;
  const auto body = [&](std::size_t t) {
    threads.note_step(t);
    while (!threads.ending()) std::this_thread::yield();
    threads.note_waited(t, 500ms);
  };
  threads.run(body, [&] {
    threads.watch(1ms, [&] {
      seen = threads.steps();
      if (seen == 2) threads.end();
    });
  });
  EXPECT_EQ(seen, 2u);
  EXPECT_EQ(threads.waited(), std::chrono::duration<double>(1));
}

// A thread that gets no turn, as here the second one, may hold what the others wait for.
TEST(WorkerThreads, SayWhetherEachHasLooked) {
  WorkerThreads threads(2);
  EXPECT_FALSE(threads.all_have_looked());
  threads.note_look(0);
  EXPECT_FALSE(threads.all_have_looked());
  threads.note_look(0);
  threads.note_look(1);
  EXPECT_TRUE(threads.all_have_looked());
  EXPECT_FALSE(threads.all_have_looked());
  threads.note_look(1);
  EXPECT_FALSE(threads.all_have_looked());
}

TEST(WorkerThreads, TheFirstExceptionEndsAll) {
  WorkerThreads threads(2);
  const auto body = [&](std::size_t t) {
    if (t == 1) throw std::runtime_error("broken");
    while (!threads.ending()) std::this_thread::yield();
  };
  threads.run(body, [&] { threads.watch(1ms, [] {}); });
  ASSERT_NE(threads.error(), nullptr);
  EXPECT_THROW(std::rethrow_exception(threads.error()), std::runtime_error);
}

/// A clock that the test moves, for the calling thread.
class StillClock final : public Schedule {
 public:
  StillClock() { follow(this); }
  ~StillClock() override { follow(nullptr); }
  void start(std::function<void()>) override {}
  void yield() override {}
  Clock::time_point now() override { return time; }

  Clock::time_point time{1s};
};

TEST(HeartbeatMonitor, IsSilentWithoutStepsWhileItsThreadRuns) {
  StillClock clock;
  HeartbeatMonitor monitor;
  const auto after = [&](std::chrono::milliseconds time, std::uint64_t beats) {
    clock.time += time;
    monitor.note_turn();
    return monitor.silent(beats);
  };
  EXPECT_FALSE(after(0ms, 1));
  EXPECT_FALSE(after(90ms, 2));
  EXPECT_FALSE(after(90ms, 2));
  EXPECT_TRUE(after(10ms, 2));
  EXPECT_EQ(monitor.last_beat(), clock.time - 100ms);
  EXPECT_FALSE(after(10ms, 3));
}

TEST(HeartbeatMonitor, TimeInWhichItsThreadDoesNotRunDoesNotCount) {
  StillClock clock;
  HeartbeatMonitor monitor;
  monitor.note_turn();
  EXPECT_FALSE(monitor.silent(1));
  clock.time += 1s;
  EXPECT_FALSE(monitor.silent(1));
  clock.time += 50ms;
  monitor.note_turn();
  EXPECT_TRUE(monitor.silent(1));
}

}  // namespace
}  // namespace carousel::ringbus
