// The stress run of queues: sound queues pass every pattern, and the errors of broken ones are found and named.
#include <gtest/gtest.h>

#include "own_queue.h"  // the example of docs/guides/queues.md
#include "ringbus/stress/delivery_checker.h"
#include "ringbus/stress/stress_run.h"
#include "tests/ringbus/queues/broken_queues.h"
#include "tests/ringbus/queues/queue_kinds.h"

namespace carousel::ringbus::stress {
namespace {

#ifdef __SANITIZE_THREAD__
constexpr std::uint64_t kMessages = 2000;
#else
constexpr std::uint64_t kMessages = 8000;
#endif

TrialOptions short_trial(Pattern pattern) {
  TrialOptions options;
  options.pattern = pattern;
  options.messages = kMessages;
  options.capacity = 16;
  options.time = std::chrono::milliseconds(200);
  return options;
}

/// Runs until all messages are sent, however slow the machine is, as errors show only after some of them.
TrialOptions full_trial(Pattern pattern) {
  TrialOptions options = short_trial(pattern);
  options.messages = 2000;
  options.time = std::chrono::seconds(60);
  return options;
}

TEST(Message, TellsEveryChangedBit) {
  const Message<kLine> message = Message<kLine>::of({5, 123456});
  ASSERT_TRUE(message.open());
  EXPECT_EQ(message.open()->producer, 5u);
  EXPECT_EQ(message.open()->number, 123456u);
  for (std::size_t bit = 0; bit < 8 * kLine; ++bit) {
    Message<kLine> changed = message;
    changed.words[bit / 64] ^= std::uint64_t{1} << bit % 64;
    EXPECT_FALSE(changed.open()) << bit;
  }
  Message<kSmall> small = Message<kSmall>::of({1, 2});
  for (std::size_t bit = 0; bit < 64; ++bit) {
    Message<kSmall> changed = small;
    changed.words[0] ^= std::uint64_t{1} << bit;
    EXPECT_FALSE(changed.open()) << bit;
  }
}

TEST(DeliveryChecker, NamesWhatHappened) {
  const auto judged = [](std::initializer_list<std::uint32_t> numbers, std::uint64_t sent) {
    std::vector<DeliveryChecker> all{DeliveryChecker(1, 100)};
    for (const std::uint32_t number : numbers) (void)all[0].take(Message<kLine>::of({0, number}));
    const std::vector<std::uint64_t> pushed{sent};
    return DeliveryChecker::judge(all, pushed).names();
  };
  EXPECT_EQ(judged({0, 1, 2}, 3), "");
  EXPECT_EQ(judged({0, 2}, 3), "lost 1");
  EXPECT_EQ(judged({0, 1}, 70), "lost 68");
  EXPECT_EQ(judged({0, 2, 1}, 3), "reordered 1");
  EXPECT_EQ(judged({0, 1, 1, 2}, 3), "doubled 1");
  EXPECT_EQ(judged({0, 1, 2, 100}, 3), "torn 1");  // nobody sent it
}

TEST(DeliveryChecker, TwoConsumersMayNotGetTheSame) {
  std::vector<DeliveryChecker> all(2, DeliveryChecker(1, 100));
  for (const std::uint32_t number : {0, 2}) (void)all[0].take(Message<kLine>::of({0, number}));
  for (const std::uint32_t number : {1, 2}) (void)all[1].take(Message<kLine>::of({0, number}));
  const std::vector<std::uint64_t> pushed{3};
  const Violations found = DeliveryChecker::judge(all, pushed);
  EXPECT_EQ(found.names(), "doubled 1");
}

class EveryPattern : public testing::TestWithParam<Pattern> {};
INSTANTIATE_TEST_SUITE_P(Stress, EveryPattern, testing::ValuesIn([] {
                           std::vector<Pattern> all;
                           for (const PatternName& entry : kPatterns) all.push_back(entry.pattern);
                           return all;
                         }()),
                         [](const auto& given) { return std::string(pattern_name(given.param)); });

TEST_P(EveryPattern, SoundQueuesComeThrough) {
  std::vector<QueueUnderTest> queues{queue_under_test<OwnQueue>("own")};
  for (const QueueKind kind : queue_kinds()) queues.push_back(named_queue(kind));
  for (const QueueUnderTest& queue : queues) {
    if (!pattern_fits(queue, GetParam())) continue;
    SCOPED_TRACE(queue.name);
    const TrialResult result = run_trial(queue, short_trial(GetParam()));
    EXPECT_EQ(result.violations.names(), "") << result.violations.detail;
    EXPECT_GT(result.messages, 0u);
    EXPECT_GT(result.seconds, 0);
    const bool round = GetParam() == Pattern::kPingPong || GetParam() == Pattern::kCirculation;
    if (round) {
      EXPECT_EQ(result.round_trip_ns.count(), result.messages);
    } else {
      EXPECT_EQ(result.round_trip_ns.count(), 0u);
      EXPECT_GT(result.transit_ns.count(), 0u);
    }
  }
}

TEST(Stress, SizesOfMessagesComeThrough) {
  for (const std::size_t bytes : {kSmall, kPacket}) {
    TrialOptions options = short_trial(Pattern::kBatches);
    options.message_bytes = bytes;
    EXPECT_EQ(run_trial(named_queue(QueueKind::kSpscRing), options).violations.names(), "");
    EXPECT_EQ(run_trial(named_queue(QueueKind::kMpmcRing), options).violations.names(), "");
  }
}

TEST(Stress, CatchesLossAtTheWrap) {
  for (const Pattern pattern : {Pattern::kStream, Pattern::kBatches, Pattern::kManyToMany}) {
    const TrialResult result = run_trial(queue_under_test<LosesAtWrap>("loses"), full_trial(pattern));
    EXPECT_GT(result.violations.lost, 0u);
    EXPECT_EQ(result.violations.doubled + result.violations.reordered + result.violations.corrupted, 0u);
    EXPECT_NE(result.violations.detail, "");
  }
}

TEST(Stress, CatchesReordering) {
  for (const Pattern pattern : {Pattern::kStream, Pattern::kBatches, Pattern::kCirculation}) {
    const TrialResult result = run_trial(queue_under_test<Reorders>("reorders"), full_trial(pattern));
    EXPECT_GT(result.violations.reordered, 0u);
    EXPECT_EQ(
        result.violations.lost + result.violations.doubled + result.violations.corrupted + result.violations.bounds,
        0u);
  }
}

TEST(Stress, CatchesTornPayloads) {
  for (const Pattern pattern : {Pattern::kStream, Pattern::kBatches}) {
    const TrialResult result = run_trial(queue_under_test<Tears>("tears"), full_trial(pattern));
    EXPECT_GT(result.violations.corrupted, 0u);
    EXPECT_EQ(
        result.violations.lost + result.violations.doubled + result.violations.reordered + result.violations.bounds,
        0u);
  }
}

TEST(Stress, CatchesWhatIsStuckAndCallsThatNeverReturn) {
  TrialOptions options = full_trial(Pattern::kStream);
  options.messages = 100'000;
  options.stuck_after = std::chrono::milliseconds(150);
  const TrialResult sticks = run_trial(queue_under_test<Sticks>("sticks"), options);
  EXPECT_TRUE(sticks.violations.stuck);
  EXPECT_NE(sticks.violations.detail.find("nothing moved for 150 ms"), std::string::npos) << sticks.violations.detail;
#ifndef __SANITIZE_THREAD__  // ThreadSanitizer would report the thread that is left behind
  const TrialResult hangs = run_trial(queue_under_test<NeverReturns>("hangs"), options);
  EXPECT_TRUE(hangs.violations.stuck);
  EXPECT_NE(hangs.violations.detail.find("had not returned"), std::string::npos) << hangs.violations.detail;
#endif
}

TEST(Stress, SlowConsumersPushBack) {
  const TrialResult slow = run_trial(named_queue(QueueKind::kSpscRing), full_trial(Pattern::kSlowConsumer));
  EXPECT_GT(slow.push_refusals, 0u);
  EXPECT_GT(slow.blocked_seconds, 0);
  EXPECT_LE(slow.blocked_seconds, slow.producer_seconds);
}

TEST(Stress, EveryQueueMeetsEveryPatternItFitsAsOftenAsTheOthers) {
  const std::vector<QueueUnderTest> queues{named_queue(QueueKind::kSpscRing), named_queue(QueueKind::kMutex),
                                           queue_under_test<Reorders>("reorders")};
  StressOptions options;
  options.patterns = {Pattern::kStream, Pattern::kManyToMany};
  options.message_bytes = {kLine};
  options.repetitions = 2;
  options.seconds = 0.2;
  options.messages = 2000;
  double last = 0;
  options.progress = [&](double part) {
    EXPECT_GT(part, last);
    last = part;
  };
  const std::vector<StressRow> rows = run_stress(queues, options);
  ASSERT_EQ(rows.size(), 5u);  // spsc_ring does not fit many_to_many
  for (const StressRow& row : rows) {
    EXPECT_EQ(row.rates.size(), 2u);
    EXPECT_EQ(row.sum.violations.any(), row.queue == 2);
    EXPECT_LE(row.least(), row.median());
    EXPECT_LE(row.median(), row.most());
  }
  EXPECT_EQ(last, 1);
}

}  // namespace
}  // namespace carousel::ringbus::stress
