// The stages of a cache, each by itself.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ringbus/cycle/shapes/cache/cache_answers.h"
#include "ringbus/cycle/shapes/cache/cache_banks.h"
#include "ringbus/cycle/shapes/cache/memory_requests.h"
#include "ringbus/cycle/shapes/cache/pending_requests.h"
#include "ringbus/cycle/shapes/cache/tag_array.h"
#include "tests/ringbus/time/loose_channel.h"

namespace carousel::ringbus::cycle {
namespace {

using testing::ElementsAre;

MemoryConfig stage_config() {
  MemoryConfig config;
  config.line_bytes = 64;
  config.l2_kib = 1;
  config.ways = 4;
  config.l2_latency_cycles = 2;
  return config;
}

template <class T>
std::vector<std::pair<Cycle, T>> all_sent_on(Channel<T>& channel) {
  std::vector<std::pair<Cycle, T>> out;
  while (channel.next() != kNever) {
    const Cycle at = channel.next();
    out.emplace_back(at, channel.take());
  }
  return out;
}

TEST(CacheBanks, APortLooksUpSoManyLinesACycle) {
  MemoryConfig config = stage_config();
  config.l2_lines_per_cycle = 2;
  CacheCounts counts;
  CacheBanks banks(config, counts);
  CacheBank& bank = banks.of(0);
  EXPECT_EQ(banks.take_port(bank, 10), 11u);
  EXPECT_EQ(banks.take_port(bank, 10), 11u);
  EXPECT_EQ(banks.take_port(bank, 10), 12u);
  EXPECT_EQ(counts.port_waits, 1u);
  EXPECT_EQ(counts.port_busy, 2u);
}

TEST(CacheBanks, LinesTakeTurnsAndEachBankHasItsMissRegisters) {
  MemoryConfig config = stage_config();
  config.l2_banks = 2;
  config.l2_mshrs = 1;
  CacheCounts counts;
  CacheBanks banks(config, counts);
  EXPECT_EQ(&banks.of(0), &banks.of(2));
  EXPECT_NE(&banks.of(0), &banks.of(1));
  banks.of(0).on_their_way = 1;
  EXPECT_FALSE(banks.can_fetch(banks.of(0)));
  EXPECT_TRUE(banks.can_fetch(banks.of(1)));
}

TEST(MemoryRequests, LeaveAtTheirTimesAndInTheOrderInWhichTheyWereMade) {
  LooseChannel<std::uint64_t> channel;
  MemoryRequests requests(channel, 5, false);
  requests.add(12, 1);
  requests.add(10, 2);
  requests.add(10, 3);
  EXPECT_EQ(requests.next(), 10u);
  requests.send_due(9);
  EXPECT_EQ(channel.next(), kNever);
  requests.send_due(10);
  requests.send_due(12);
  EXPECT_EQ(requests.next(), kNever);
  EXPECT_THAT(all_sent_on(channel), ElementsAre(std::pair(15u, 2u), std::pair(15u, 3u), std::pair(17u, 1u)));
}

TEST(CacheAnswers, FollowOneAnotherOnTheWires) {
  MemoryConfig config = stage_config();
  config.l2_answer_bytes_per_cycle = 32;
  LooseChannel<FetchAnswer> answers;
  LooseChannel<std::uint64_t> to_own_cache;
  const std::vector<OwnCacheClient> own_caches{{nullptr, &to_own_cache}};
  const std::vector<CacheClient> clients{{nullptr, &answers}};
  CacheCounts counts;
  CacheAnswers stage(config, own_caches, clients, counts);
  stage.add({20, 1, 7, 0, 2});  // 128 bytes in 4 cycles
  stage.add({20, 0, 0, 99, 1});
  EXPECT_EQ(stage.next(), 20u);
  stage.send_due(20);
  EXPECT_EQ(stage.next(), kNever);
  EXPECT_EQ(answers.next(), 20u + 4 - 1 + 1);
  EXPECT_EQ(answers.take().tag, 7u);
  EXPECT_EQ(to_own_cache.next(), 20u + 6 - 1 + 1);
  EXPECT_EQ(to_own_cache.take(), 99u);
}

TEST(CacheAnswers, GoToTheOthersToo) {
  const MemoryConfig config = stage_config();
  LooseChannel<FetchAnswer> answers[3];
  LooseChannel<PushedShapes> pushed[3];
  const std::vector<OwnCacheClient> own_caches;
  std::vector<CacheClient> clients;
  for (std::size_t c = 0; c < 3; ++c) clients.push_back({nullptr, &answers[c], &pushed[c]});
  CacheCounts counts;
  CacheAnswers stage(config, own_caches, clients, counts);
  FetchRequest request{5, 1, 3};
  request.skipped = 16;
  request.wanted = 40;
  request.others = 0b110;
  stage.add({8, 0, 3, 0, 1, stage.begin_push(request)});
  stage.send_due(8);
  EXPECT_EQ(answers[0].take().tag, 3u);
  EXPECT_EQ(pushed[0].next(), kNever);
  for (const std::size_t c : {1u, 2u}) {
    EXPECT_EQ(pushed[c].next(), 9u);
    EXPECT_EQ(pushed[c].front().address, 5u * 64 + 16);
    EXPECT_EQ(pushed[c].take().size, 40u);
  }
  EXPECT_EQ(counts.pushed, 2u);
}

TEST(TagArray, RayDataReplaceNoShapes) {
  MemoryConfig config = stage_config();  // four sets of four ways
  config.l2_ray_ways = 1;
  TagArray tags(config);
  const std::uint64_t ray_line = (std::uint64_t{1} << 40) / 64;
  tags.insert(0);
  for (std::uint64_t i = 0; i < 5; ++i) tags.insert(ray_line + 4 * i);
  EXPECT_TRUE(tags.touch(0));
  EXPECT_TRUE(tags.touch(ray_line + 16));
  EXPECT_FALSE(tags.touch(ray_line));
  EXPECT_THAT(tags.lines(), ElementsAre(0u, ray_line + 16));
}

TEST(TagArray, WrittenLinesAreTakenByAddressAndOnce) {
  MemoryConfig config = stage_config();
  config.l2_write = MemoryConfig::Write::kBack;
  TagArray tags(config);
  for (const std::uint64_t line : {7u, 2u, 5u}) {
    tags.insert(line);
    if (line != 2) tags.written(line);
  }
  EXPECT_THAT(tags.take_written(), ElementsAre(5u, 7u));
  EXPECT_TRUE(tags.take_written().empty());
}

TEST(PendingRequests, AreCompleteWithTheirLastLineAndReadyWithTheLatest) {
  PendingRequests pending(0);
  PendingRequests::Request request;
  request.lines_missing = request.lines = 2;
  const std::uint32_t index = pending.begin(request);
  pending.looked_up(index, 30);
  EXPECT_FALSE(pending.there(index, 4, 20));
  EXPECT_TRUE(pending.there(index, 5, 25));
  EXPECT_EQ(pending[index].ready, 30u);
  pending.end(index);
  EXPECT_EQ(pending.begin(request), index);
}

TEST(PendingRequests, TellTheWalkAlongAStripOfLinesThatAreThere) {
  PendingRequests pending(0);
  PendingRequests::Request request;
  request.lines_missing = request.lines = 2;
  const std::uint32_t index = pending.begin(request), walk = pending.begin_walk(index, 10);
  EXPECT_EQ(pending.walks().next_line(walk)->line, 10u);
  EXPECT_FALSE(pending.walks().next_line(walk));
  EXPECT_FALSE(pending.there(index, 10, 40));
  EXPECT_EQ(pending.walks().next(), 40u);
  EXPECT_EQ(pending.walks().take(), walk);
  EXPECT_EQ(pending.walks().next_line(walk)->line, 11u);
}

}  // namespace
}  // namespace carousel::ringbus::cycle
