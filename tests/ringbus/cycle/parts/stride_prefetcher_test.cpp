// The prefetcher between a reader of lines, an L2 and a memory.
#include "ringbus/cycle/parts/stride_prefetcher/stride_prefetcher.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "ringbus/cycle/memory/memory_agent.h"
#include "ringbus/cycle/shapes/shape_cache.h"
#include "ringbus/time/windows.h"

namespace carousel::ringbus::cycle::stride_prefetcher_test {
namespace {

/// Asks for lines one by one, the next when the last has come, and tells the prefetcher, if there is one.
class LineReader final : public Agent {
 public:
  LineReader(std::vector<std::uint64_t> lines, Channel<FetchRequest>& requests, Channel<FetchAnswer>& answers,
             Channel<ShapeHint>* hints)
      : lines_(std::move(lines)), requests_(requests), answers_(answers), hints_(hints) {}
  Cycle next() const override { return asked_ == 0 ? 1 : answers_.next(); }
  bool polled() const override { return false; }
  void run(Cycle end) override {
    for (Cycle now; (now = next()) < end;) {
      if (asked_ > 0) answers_.take(), done_ = now;
      if (asked_ == lines_.size()) return;
      const std::uint64_t line = lines_[asked_++];
      requests_.send(now + 20, {line, 1});
      if (hints_ != nullptr) hints_->send(now + 20, {line});
    }
  }
  std::string describe() const override { return ""; }
  Cycle done() const { return done_; }

 private:
  std::vector<std::uint64_t> lines_;
  Channel<FetchRequest>& requests_;
  Channel<FetchAnswer>& answers_;
  Channel<ShapeHint>* hints_;
  std::size_t asked_ = 0;
  Cycle done_ = 0;
};

struct Outcome {
  Cycle cycles = 0;
  CacheCounts cache;
  AheadCounts ahead;
  std::optional<StridePrefetcherCounts> counts;
  std::vector<ByteRow> rows;
};

/// The reader, an L2 and its memory on two threads; with `lines` of 0 there is no prefetcher.
Outcome read(const std::vector<std::uint64_t>& lines, const StridePrefetcherKeys& keys, std::int64_t mshrs = 0) {
  MemoryConfig memory;
  memory.l2_kib = 16;
  memory.l2_latency_cycles = 20;
  memory.dram_latency_cycles = 200;
  memory.l2_mshrs = mshrs;
  memory.l2_lines_per_cycle = 1;
  const LinkConfig link;
  enum Number : std::uint32_t { kReader, kCache, kMemory, kPrefetcher };
  ChannelList list;
  const FetchKinds kinds(list, memory, 32);
  const MemoryKinds of_memory(list, memory);
  const Cycle there = ShapeCache::request_latency(memory), back = ShapeCache::answer_latency(memory);
  Channel<FetchRequest> requests(list.at(kinds.requests, {kReader, kCache, there}));
  Channel<FetchAnswer> answers(list.at(kinds.data, {kCache, kReader, back}));
  Channel<std::uint64_t> down(list.at(of_memory.requests, {kCache, kMemory, MemoryAgent::request_latency(memory)}));
  Channel<std::uint64_t> up(list.at(of_memory.lines, {kMemory, kCache, MemoryAgent::answer_latency(memory)}));
  std::vector<ShapeCache::Client> clients{{&requests, &answers}};
  std::vector<AttachedPart<StridePrefetcherCounts>> parts;
  if (StridePrefetcherPart::is_built(keys)) {
    parts = attach(keys, {list, memory, link, {{kPrefetcher, kCache, {kReader}}}});
    clients.push_back({parts[0].ahead});
  }
  ShapeCache cache(memory, clients, down, up);
  const std::unique_ptr<MemoryAgent> dram = make_memory(memory, 1000, {{&down, &up}});
  LineReader reader(lines, requests, answers, parts.empty() ? nullptr : parts[0].hints[0]);
  std::vector<std::vector<Agent*>> threads{{&reader, &cache}, {dram.get()}};
  std::vector<const Agent*> agents{&reader, &cache, dram.get()};
  for (const auto& part : parts) {
    threads.back().push_back(part.agent.get());
    agents.push_back(part.agent.get());
  }
  WakeupTable wakeups(threads);
  list.connect(wakeups, agents);
  run_windows(threads, wakeups, list.least_latency(), Sharing::kAlways, [](Cycle) { return true; });
  Outcome out{reader.done(), cache.statistics(), cache.ahead(), {}, list.rows()};
  if (!parts.empty()) out.counts = parts[0].agent->counts();
  return out;
}

constexpr std::size_t kLines = 200;

/// Lines in steps.
std::vector<std::uint64_t> in_steps(std::int64_t first, std::int64_t step) {
  std::vector<std::uint64_t> out;
  for (std::size_t i = 0; i < kLines; ++i)
    out.push_back(static_cast<std::uint64_t>(first + step * static_cast<std::int64_t>(i)));
  return out;
}

TEST(StridePrefetcher, FetchesAStreamAheadAndEachWireIsInTheLedger) {
  const Outcome without = read(in_steps(1000, 3), {});
  EXPECT_EQ(without.cache.misses, kLines);
  EXPECT_EQ(without.ahead, AheadCounts{});
  const Outcome with = read(in_steps(1000, 3), {.lines = 2});
  // It is sure of the stride at the third line; from then on two lines are asked for, and one more with each line.
  const StridePrefetcherCounts expected{
      .hints = kLines, .streams = 1, .followed = kLines - 2, .lines = kLines - 3 + 2, .met = kLines - 3};
  EXPECT_EQ(with.counts, expected);
  EXPECT_EQ(with.ahead, (AheadCounts{.asked = expected.lines, .found = 0, .fetched = expected.lines, .dropped = 0}));
  EXPECT_EQ(with.cache.lines, kLines);  // those that were asked for ahead are no look-ups of clients
  EXPECT_EQ(with.cache.misses, 3u);
  EXPECT_EQ(with.cache.port_busy, kLines + expected.lines);  // each takes the port for a cycle
  EXPECT_LT(2 * with.cycles, without.cycles);
  ASSERT_EQ(with.rows.size(), without.rows.size() + 2);
  const std::uint64_t bytes[] = {8 * kLines, 16 * expected.lines};
  for (std::size_t i = 0; i < 2; ++i) {
    const ByteRow& row = with.rows[without.rows.size() + i];
    EXPECT_EQ(row.bytes, bytes[i]) << row.what;
    EXPECT_EQ(row.bytes, row.bytes_taken) << row.what;
  }
  EXPECT_EQ(with.rows[ChannelList::index(MessageKind{3})].bytes, 64 * (3 + expected.lines));  // from memory
}

TEST(StridePrefetcher, FollowsStridesThatGoDown) {
  const Outcome with = read(in_steps(5000, -2), {.lines = 2});
  EXPECT_EQ(with.cache.misses, 3u);
  EXPECT_GT(read(in_steps(3 * kLines - 3, -3), {.lines = 16}).ahead.fetched, 0u);  // to line 0, and not past it
}

TEST(StridePrefetcher, MoreLinesAheadHideMoreOfTheLatency) {
  const Cycle two = read(in_steps(1000, 1), {.lines = 2}).cycles;
  EXPECT_LT(read(in_steps(1000, 1), {.lines = 4}).cycles, two);
}

TEST(StridePrefetcher, FollowsAsManyStreamsAsItHasPlaces) {
  std::vector<std::uint64_t> two_streams;
  for (std::uint64_t i = 0; i < kLines; ++i) two_streams.push_back(i % 2 == 0 ? 1000 + i : 90000 + 2 * i);
  EXPECT_EQ(read(two_streams, {.lines = 2, .streams = 1}).counts->followed, 0u);
  EXPECT_EQ(read(two_streams, {.lines = 2, .streams = 2}).counts->followed, kLines - 4);
}

TEST(StridePrefetcher, AStreamReachesSoFar) {
  EXPECT_EQ(read(in_steps(1000, 9), {.lines = 2, .reach = 8}).counts->lines, 0u);
  EXPECT_GT(read(in_steps(1000, 9), {.lines = 2, .reach = 9}).counts->lines, 0u);
}

TEST(StridePrefetcher, LinesWithoutAMissRegisterAreDropped) {
  const Outcome with = read(in_steps(1000, 1), {.lines = 4}, 1);
  EXPECT_GT(with.ahead.dropped, 0u);
  EXPECT_EQ(with.ahead.asked, with.ahead.found + with.ahead.fetched + with.ahead.dropped);
  EXPECT_EQ(with.cache.hits + with.cache.merged + with.cache.misses, kLines);
}

}  // namespace
}  // namespace carousel::ringbus::cycle::stride_prefetcher_test
