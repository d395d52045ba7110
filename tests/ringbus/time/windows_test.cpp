// Agents on several threads: what one thread decides ends all of them.
#include "ringbus/time/windows.h"

#include <algorithm>
#include <chrono>
#include <memory>
#include <stdexcept>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "tests/ringbus/time/loose_channel.h"

namespace carousel::ringbus {
namespace {

/// Has something to do in every cycle, and fails in one of them.
class Ticker final : public Agent {
 public:
  explicit Ticker(Cycle fails_at = kNever) : fails_at_(fails_at) {}

  Cycle next() const override { return now_ + 1; }
  void run(Cycle end) override {
    while (now_ + 1 < end)
      if (++now_ == fails_at_) throw std::runtime_error("as planned");
  }
  std::string describe() const override { return ""; }

 private:
  Cycle now_ = 0, fails_at_;
};

/// One agent a thread, the last of which fails.
std::vector<std::vector<Agent*>> parts_of(std::vector<std::unique_ptr<Ticker>>& agents, std::size_t threads,
                                          Cycle fails_at) {
  std::vector<std::vector<Agent*>> parts(threads);
  for (std::size_t t = 0; t < threads; ++t)
    parts[t].push_back(agents.emplace_back(std::make_unique<Ticker>(t + 1 == threads ? fails_at : kNever)).get());
  return parts;
}

// A thread that is told in the middle of a window must not leave before the others, who would wait for it for ever.
TEST(Windows, AnErrorInOneThreadEndsAllOfThem) {
  for (const std::size_t threads : {1, 2, 3, 5}) {
    for (Cycle fails_at = 1; fails_at < 60; ++fails_at) {
      std::vector<std::unique_ptr<Ticker>> agents;
      const std::vector<std::vector<Agent*>> parts = parts_of(agents, threads, fails_at);
      WakeupTable wakeups(parts);
      EXPECT_THROW(run_windows(parts, wakeups, 1, Sharing::kAlways, [](Cycle) { return true; }), std::runtime_error);
    }
  }
}

TEST(Windows, AStopEndsAllThreads) {
  for (const std::size_t threads : {1, 2, 3, 5}) {
    for (int i = 0; i < 30; ++i) {
      std::vector<std::unique_ptr<Ticker>> agents;
      const std::vector<std::vector<Agent*>> parts = parts_of(agents, threads, kNever);
      WakeupTable wakeups(parts);
      EXPECT_LT(run_windows(parts, wakeups, 1, Sharing::kAlways, [](Cycle) { return false; }), 10u);
    }
  }
}

/// Has something to do in each of many cycles, and notes on which thread.
class Placed final : public Agent {
 public:
  /// `elsewhere_takes`: how long it runs on another thread than the one on which it is made.
  explicit Placed(std::chrono::milliseconds elsewhere_takes = {}) : elsewhere_takes_(elsewhere_takes) {}

  Cycle next() const override { return now_ < kCycles ? now_ + 1 : kNever; }
  void run(Cycle end) override {
    now_ = end - 1;
    ++runs_;
    if (std::this_thread::get_id() == made_on_) return;
    ++elsewhere_;
    std::this_thread::sleep_for(elsewhere_takes_);
  }
  std::string describe() const override { return ""; }
  std::uint64_t runs() const { return runs_; }
  std::uint64_t elsewhere() const { return elsewhere_; }

 private:
  static constexpr Cycle kCycles = 640;
  std::chrono::milliseconds elsewhere_takes_;
  Cycle now_ = 0;
  std::uint64_t runs_ = 0, elsewhere_ = 0;
  std::thread::id made_on_ = std::this_thread::get_id();
};

// Before issue 45 two threads took ten times as long as one for machines with little to do in a window.
TEST(Windows, FewAgentsRunOnOneThreadAndManyOnTheirOwn) {
  for (const std::size_t each : {1, 3, 20}) {
    std::vector<std::unique_ptr<Placed>> agents;
    std::vector<std::vector<Agent*>> parts(2);
    for (std::vector<Agent*>& part : parts)
      for (std::size_t i = 0; i < each; ++i) part.push_back(agents.emplace_back(std::make_unique<Placed>()).get());
    WakeupTable wakeups(parts);
    std::vector<Cycle> looks;
    run_windows(parts, wakeups, 1, Sharing::kAlways, [&](Cycle at) {
      looks.push_back(at);
      return true;
    });
    for (std::size_t i = 0; i < agents.size(); ++i) {
      EXPECT_EQ(agents[i]->runs(), 640u);
      EXPECT_EQ(agents[i]->elsewhere(), i < each ? 0u : each < 8 ? 64u : 640u) << each << " agents a thread";
    }
    for (std::size_t i = 0; i < looks.size(); ++i) EXPECT_EQ(looks[i], 1 + 64 * i);  // as on one thread
    EXPECT_EQ(looks.size(), 10u);
  }
}

// A thread whose core has other work holds up all others in every window.
TEST(Windows, OneThreadRunsAllWhileOthersHoldItUp) {
  std::vector<std::unique_ptr<Placed>> agents;
  std::vector<std::vector<Agent*>> parts(2);
  for (std::size_t i = 0; i < 40; ++i)
    parts[i / 20].push_back(
        agents.emplace_back(std::make_unique<Placed>(std::chrono::milliseconds(i == 39 ? 2 : 0))).get());
  WakeupTable wakeups(parts);
  run_windows(parts, wakeups, 1, Sharing::kWhenFaster, [](Cycle) { return true; });
  for (const auto& agent : agents) EXPECT_EQ(agent->runs(), 640u);
  EXPECT_GE(agents[39]->elsewhere(), 64u) << "both ways are tried";
  EXPECT_LE(agents[39]->elsewhere(), 320u);
}

/// Works in every third cycle, and notes when.
class Worker final : public Agent {
 public:
  Cycle next() const override { return next_ < 400 ? next_ : kNever; }
  void run(Cycle end) override {
    for (; next() < end; next_ += 3) last_ = next_;
  }
  std::string describe() const override { return ""; }
  Cycle last() const { return last_; }

 private:
  Cycle next_ = 2, last_ = 0;
};

// Whoever looks finds all that comes before, and nothing that comes after, on any number of threads.
TEST(Windows, ALookFindsWhatComesBeforeIt) {
  for (const std::size_t threads : {1, 2, 3})
    for (const std::size_t each : {1, 20})
      for (const Cycle every : {1, 2, 7, 50}) {
        const Sharing sharing = every % 2 == 0 ? Sharing::kAlways : Sharing::kWhenFaster;
        std::vector<std::unique_ptr<Worker>> agents;
        std::vector<std::vector<Agent*>> parts(threads);
        for (std::vector<Agent*>& part : parts)
          for (std::size_t i = 0; i < each; ++i) part.push_back(agents.emplace_back(std::make_unique<Worker>()).get());
        WakeupTable wakeups(parts);
        Cycle looks = 0;
        const auto look = [&](Cycle at) {
          EXPECT_EQ(at, ++looks * every);
          // The last of 2, 5, 8 and so on to 398 before it.
          const Cycle last = at < 3 ? 0 : std::min<Cycle>(398, (at - 3) / 3 * 3 + 2);
          for (const auto& agent : agents) EXPECT_EQ(agent->last(), last) << at;
          return at + every;
        };
        run_windows(
            parts, wakeups, 5, sharing, [](Cycle) { return true; }, look, every);
        EXPECT_EQ(looks, 402 / every) << threads << " threads";  // the last window ends with cycle 402
      }
}

TEST(Windows, ALookThatThrowsEndsAllThreads) {
  for (const std::size_t threads : {1, 2, 3})
    for (const std::size_t each : {1, 20}) {
      std::vector<std::unique_ptr<Worker>> agents;
      std::vector<std::vector<Agent*>> parts(threads);
      for (std::vector<Agent*>& part : parts)
        for (std::size_t i = 0; i < each; ++i) part.push_back(agents.emplace_back(std::make_unique<Worker>()).get());
      WakeupTable wakeups(parts);
      const auto look = [](Cycle at) -> Cycle {
        if (at == 351) throw std::runtime_error("the meter is broken");
        return at + 7;
      };
      EXPECT_THROW(run_windows(
                       parts, wakeups, 5, Sharing::kAlways, [](Cycle) { return true; }, look, 1),
                   std::runtime_error);
      for (const auto& agent : agents) EXPECT_LT(agent->last(), 356u) << "no further window begins";
    }
}

/// Sends to another; runs only when it is told.
class Listener final : public Agent {
 public:
  Listener(Channel<int>& in, Channel<int>& out, Cycle latency, bool starts)
      : in_(in), out_(out), latency_(latency), starts_(starts) {}

  Cycle next() const override { return starts_ ? 1 : in_.next(); }
  bool polled() const override { return false; }
  void run(Cycle end) override {
    for (Cycle now; (now = next()) < end;) {
      const int value = starts_ ? 0 : in_.take() + 1;
      starts_ = false;
      heard_.push_back(now);
      if (value < 1000) out_.send(now + latency_, value);
    }
  }
  std::string describe() const override { return ""; }
  const std::vector<Cycle>& heard() const { return heard_; }

 private:
  Channel<int>& in_;
  Channel<int>& out_;
  Cycle latency_;
  bool starts_;
  std::vector<Cycle> heard_;
};

/// Two that send to each other, of which the first one starts.
struct TwoListeners {
  LooseChannel<int> there, back;
  Listener a{back, there, 3, true}, b{there, back, 7, false};

  std::vector<std::vector<Agent*>> parts(std::size_t threads) {
    std::vector<std::vector<Agent*>> parts(threads);
    parts.front().push_back(&a);
    parts.back().push_back(&b);
    return parts;
  }
};

TEST(Windows, WhoIsNotAskedIsWokenInTime) {
  for (const std::size_t threads : {1, 2}) {
    TwoListeners two;
    const std::vector<std::vector<Agent*>> parts = two.parts(threads);
    WakeupTable wakeups(parts);
    wakeups.connect(two.there, two.a, two.b);
    wakeups.connect(two.back, two.b, two.a);
    run_windows(parts, wakeups, 3, Sharing::kAlways, [](Cycle) { return true; });
    const std::vector<Cycle>&a = two.a.heard(), &b = two.b.heard();
    ASSERT_EQ(a.size() + b.size(), 1001u);
    for (std::size_t i = 0; i < b.size(); ++i) {
      EXPECT_EQ(a[i], 1 + 10 * i);
      EXPECT_EQ(b[i], 4 + 10 * i);
    }
  }
}

// Channels are left unconnected, so that the second agent is not woken for what the first one sends.
TEST(Windows, WhoIsNotWokenIsNoticedAtTheEnd) {
  if (!kChecked) GTEST_SKIP() << "only checked builds look";
  for (const std::size_t threads : {1, 2}) {
    TwoListeners two;
    const std::vector<std::vector<Agent*>> parts = two.parts(threads);
    WakeupTable wakeups(parts);
    EXPECT_THROW(run_windows(parts, wakeups, 3, Sharing::kAlways, [](Cycle) { return true; }), std::logic_error);
  }
}

TEST(Windows, WhoIsWokenLateIsNoticed) {
  if (!kChecked) GTEST_SKIP() << "only checked builds look";
  TwoListeners two;
  Ticker others;
  std::vector<std::vector<Agent*>> parts = two.parts(1);
  parts.front().push_back(&others);
  WakeupTable wakeups(parts);
  const auto wake_late = [&](Cycle at) {
    if (at > 1) wakeups.row(0, 0)[1] = at;
    return at < 10'000;
  };
  EXPECT_THROW(run_windows(parts, wakeups, 3, Sharing::kAlways, wake_late), std::logic_error);
  EXPECT_TRUE(two.b.heard().empty());
}

}  // namespace
}  // namespace carousel::ringbus
