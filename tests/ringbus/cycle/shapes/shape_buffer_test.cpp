// The shape buffer: a bound that holds, and data that is there when its last line is.
#include "ringbus/cycle/shapes/shape_buffer.h"

#include <gtest/gtest.h>

#include "ringbus/cycle/shapes/shape_room.h"
#include "tests/ringbus/support/timed_machine.h"
#include "tests/ringbus/time/loose_channel.h"

namespace carousel::ringbus::cycle {
namespace {

using Users = std::vector<ShapeBuffer::User>;

/// A buffer of some KiB whose cache is played by the test, and strips of 256 bytes.
struct BufferBench {
  explicit BufferBench(std::int64_t kib, MemoryConfig::ShapeStay stay = MemoryConfig::ShapeStay::kUntilReplaced) {
    MemoryConfig config;
    config.shape_stay = stay;
    config.shape_buffer_kib = kib;
    config.l2_latency_cycles = 2;
    SidePorts ports;
    ports.fetch = &requests;
    ports.fetched = &answers;
    ports.pushed = &pushed;
    buffer = std::make_unique<ShapeBuffer>(config, LinkConfig{}, ports);
  }
  static ShapeSpan strip(std::uint64_t i) { return {256 * i, 256}; }
  static ShapeNeed need(std::uint64_t i) { return {strip(i), {}}; }
  /// The strips asked for since the last call.
  std::vector<std::uint64_t> asked() {
    std::vector<std::uint64_t> out;
    for (; requests.next() != kNever;) {
      const FetchRequest request = requests.take();
      out.push_back(request.first_line / 4);
      waiting.push_back(request.tag);
    }
    return out;
  }
  /// Answers what was asked for first.
  Users answer(Cycle now) {
    (void)asked();
    answers.send(now, {waiting.front()});
    waiting.erase(waiting.begin());
    buffer->take_answers(now);
    return ready();
  }
  Users ready() { return std::exchange(buffer->ready(), {}); }

  LooseChannel<FetchRequest> requests;
  LooseChannel<FetchAnswer> answers;
  LooseChannel<PushedShapes> pushed;
  std::vector<std::uint32_t> waiting;
  std::unique_ptr<ShapeBuffer> buffer;
};

using Asked = std::vector<std::uint64_t>;

TEST(ShapeBuffer, AStripIsThereWhenItsLastLineIs) {
  BufferBench bench(1);
  EXPECT_FALSE(bench.buffer->take(0, bench.need(7), 10));
  EXPECT_FALSE(bench.buffer->take(1, bench.need(7), 11));  // on its way is not here
  EXPECT_EQ(bench.asked(), Asked{7});
  EXPECT_EQ(bench.answer(50), (Users{0, 1}));
  EXPECT_TRUE(bench.buffer->take(2, bench.need(7), 50));
  EXPECT_EQ(bench.buffer->counts().misses, 1u);
  EXPECT_EQ(bench.buffer->counts().merged, 1u);
  EXPECT_EQ(bench.buffer->counts().hits, 1u);
}

TEST(ShapeBuffer, WhatIsHeldKeepsItsPlace) {
  BufferBench bench(1);  // four strips
  for (ShapeBuffer::User user = 0; user < 6; ++user) EXPECT_FALSE(bench.buffer->take(user, bench.need(user), 0));
  EXPECT_EQ(bench.asked(), (Asked{0, 1, 2, 3}));
  for (ShapeBuffer::User user = 0; user < 4; ++user) EXPECT_EQ(bench.answer(10), Users{user});
  EXPECT_EQ(bench.asked(), Asked{});  // all are held
  bench.buffer->release(2, 20);
  EXPECT_EQ(bench.asked(), Asked{4});
  EXPECT_TRUE(bench.buffer->take(6, bench.need(3), 21));   // no room needed
  EXPECT_FALSE(bench.buffer->take(7, bench.need(2), 22));  // gave up its place; behind user 5
  bench.buffer->release(3, 23);
  EXPECT_EQ(bench.asked(), Asked{});  // user 6 holds it
  bench.buffer->release(0, 24);
  bench.buffer->release(1, 25);
  EXPECT_EQ(bench.asked(), (Asked{5, 2}));
  EXPECT_EQ(bench.buffer->counts().evictions, 3u);
  EXPECT_EQ(bench.buffer->counts().room_waits, 3u);
}

TEST(ShapeBuffer, GivesUpWhatWasGivenBackLongestAgo) {
  BufferBench bench(1);
  for (const ShapeBuffer::User user : {0u, 1u, 2u, 3u}) bench.buffer->take(user, bench.need(user), 0);
  for (int i = 0; i < 4; ++i) bench.answer(10);
  for (const ShapeBuffer::User user : {2u, 0u, 3u, 1u}) bench.buffer->release(user, 20);
  EXPECT_TRUE(bench.buffer->take(0, bench.need(2), 21));
  bench.buffer->release(0, 22);
  bench.buffer->take(1, bench.need(8), 23);  // takes the place of 0
  EXPECT_TRUE(bench.buffer->take(2, bench.need(3), 24));
  EXPECT_FALSE(bench.buffer->take(3, bench.need(0), 25));  // takes the place of 1
  EXPECT_TRUE(bench.buffer->take(4, bench.need(2), 26));
  EXPECT_EQ(bench.asked(), (Asked{8, 0}));
}

TEST(ShapeBuffer, WhatATestNeedsIsTakenTogether) {
  BufferBench bench(1);
  for (const ShapeBuffer::User user : {0u, 1u, 2u}) bench.buffer->take(user, bench.need(user), 0);
  for (int i = 0; i < 3; ++i) bench.answer(10);
  const ShapeNeed both{bench.strip(5), {256 * 6, 84}};
  EXPECT_FALSE(bench.buffer->take(3, both, 20));  // six places, and four are free
  EXPECT_EQ(bench.asked(), Asked{});
  bench.buffer->release(1, 30);
  EXPECT_EQ(bench.asked(), (Asked{5, 6}));
  EXPECT_EQ(bench.answer(40), Users{});
  EXPECT_EQ(bench.answer(50), Users{3});
}

TEST(ShapeBuffer, TheIssueQueueGivesWayToTests) {
  BufferBench bench(1);
  for (const ShapeBuffer::User user : {10u, 11u, 12u, 13u, 14u}) bench.buffer->take_ahead(user, bench.need(user), 0);
  EXPECT_EQ(bench.asked(), (Asked{10, 11, 12, 13}));
  for (int i = 0; i < 4; ++i) EXPECT_EQ(bench.answer(10), Users{});
  EXPECT_TRUE(bench.buffer->is_here(13));
  EXPECT_FALSE(bench.buffer->take(0, bench.need(0), 20));
  EXPECT_EQ(bench.asked(), Asked{0});
  EXPECT_FALSE(bench.buffer->is_here(13));  // the last one that had its data
  EXPECT_TRUE(bench.buffer->is_here(12));
  EXPECT_EQ(bench.answer(30), Users{0});
  bench.buffer->leave_queue(10);
  bench.buffer->hand_over(10, 1);
  bench.buffer->release(1, 40);
  EXPECT_EQ(bench.asked(), Asked{13});
  bench.buffer->clear_queue(50);
  EXPECT_FALSE(bench.buffer->take(2, bench.need(2), 51));
  EXPECT_EQ(bench.buffer->counts().room_waits, 0u);
}

constexpr MemoryConfig::ShapeStay kWhileUsed = MemoryConfig::ShapeStay::kWhileUsed;

TEST(ShapesStayWhileUsed, TheLastHolderFreesThePlaces) {
  BufferBench bench(1, kWhileUsed);
  bench.buffer->take(0, bench.need(7), 0);
  bench.buffer->take(1, bench.need(7), 0);
  EXPECT_EQ(bench.answer(10), (Users{0, 1}));
  bench.buffer->release(0, 20);
  EXPECT_TRUE(bench.buffer->take(0, bench.need(7), 21));  // user 1 holds it
  bench.buffer->release(0, 22);
  bench.buffer->release(1, 23);
  EXPECT_FALSE(bench.buffer->has(bench.strip(7)));
  EXPECT_FALSE(bench.buffer->take(2, bench.need(7), 24));
  EXPECT_EQ(bench.asked(), Asked{7});
  bench.buffer->release(2, 25);  // gives it up on its way
  EXPECT_EQ(bench.answer(30), Users{});
  EXPECT_FALSE(bench.buffer->has(bench.strip(7)));
  EXPECT_EQ(bench.buffer->counts().evictions, 0u);
}

// The last packet of the queue is the only one to hold what the test needs as well.
TEST(ShapesStayWhileUsed, WhatTheIssueQueueGivesUpMayBeWhatATestNeeds) {
  BufferBench bench(1, kWhileUsed);
  for (const ShapeBuffer::User user : {10u, 11u, 12u, 13u}) bench.buffer->take_ahead(user, bench.need(user), 0);
  for (int i = 0; i < 4; ++i) bench.answer(10);
  EXPECT_FALSE(bench.buffer->take(0, {bench.strip(13), {256 * 20, 84}}, 20));
  EXPECT_FALSE(bench.buffer->is_here(12));  // six places were needed when 13 had gone
  EXPECT_TRUE(bench.buffer->is_here(11));
  EXPECT_EQ(bench.asked(), (Asked{13, 20}));
  EXPECT_EQ(bench.answer(30), Users{});
  EXPECT_EQ(bench.answer(31), Users{0});
}

TEST(ShapesStayWhileUsed, ButWhatOthersAskedForWaitsForItsPacket) {
  BufferBench bench(1, kWhileUsed);
  bench.pushed.send(5, {256 * 3, 256});
  bench.buffer->take_answers(5);
  EXPECT_TRUE(bench.buffer->take(0, bench.need(3), 6));
  bench.buffer->release(0, 7);
  EXPECT_FALSE(bench.buffer->has(bench.strip(3)));
}

// One ray at a time: what is dropped is fetched again for each test, and what stays is fetched once.
TEST(ShapesStayWhileUsed, ARayAloneFetchesForEachTest) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 3000, 0), 40, 1);
  const std::string machine =
      "topology: {resources: 1}\nrays: {slots_per_resource: 1}\npackets: {rays: 1}\n"
      "collections: {ready: 1, traversal: ordered}\n"
      "shading: {workers: 1, cycles_per_shade: 1}\n"
      "memory: {shape_buffer_kib: 4096, fetch_ahead: 0, l2_kib: 4096, l2_latency_cycles: 300}\n";
  const auto run = [&](const char* stay) {
    return *run_text(scene, machine, {std::string("memory.shape_stay=") + stay}).result.cycle;
  };
  const CycleResult kept = run("until_replaced"), dropped = run("while_used");
  const ShapeBufferCounts a = kept.tiles[0].shapes, b = dropped.tiles[0].shapes;
  EXPECT_GT(a.hits, a.misses);
  EXPECT_EQ(b.misses, a.hits + a.misses);
  EXPECT_EQ(b.hits, 0u);
  EXPECT_EQ(a.merged + b.merged + a.evictions + b.evictions, 0u);
  EXPECT_GE(dropped.cycles, kept.cycles + 300 * a.hits);
}

constexpr const char* kMachine =
    "topology: {resources: 2}\nrays: {slots_per_resource: 64}\npackets: {rays: 8}\ncollections: {ready: 8}\n"
    "shading: {workers: 8, cycles_per_shade: 1}\n";

TEST(ShapeBufferSize, FourAndSevenKibibytesDiffer) {
  TestScene scene(builtin_scene(BuiltinScene::kTerrain, 3000, 0), 400, 1);
  std::uint64_t smaller = ~std::uint64_t{0};
  for (const std::string kib : {"1", "4", "7", "16"}) {
    const Outcome out = run_text(scene, kMachine, {"memory.shape_buffer_kib=" + kib});
    std::uint64_t misses = 0;
    for (const TileResult& tile : out.result.cycle->tiles) misses += tile.shapes.misses;
    EXPECT_LT(misses, smaller) << kib;
    smaller = misses;
  }
}

TEST(ShapeBufferSize, HoldsTheLargestStripOfTheScene) {
  TestScene scene(builtin_scene(BuiltinScene::kInstances, 0, 60), 20, 1);
  const auto issues = [&](const std::string& text) {
    const Config config =
        load_config({"scene: {builtin: instances}\nengine: {kind: cycle}\n" + text, "machine.yaml"}).config;
    return check_shape_buffer(config, scene.accel(config.bvh, config.cull_planes, config.accuracy));
  };
  EXPECT_TRUE(issues("memory: {shape_buffer_kib: 1}\n").empty());
  const std::vector<ConfigIssue> found =
      issues("cull_planes: {count: 8, nodes: all, levels: all}\nmemory: {shape_buffer_kib: 1}\n");
  ASSERT_EQ(found.size(), 1u);
  EXPECT_EQ(
      found[0].text(),
      "memory.shape_buffer_kib: a test needs a whole strip and its transform at once, and this scene's largest do "
      "not fit; expected at least 2, found 1");
}

}  // namespace
}  // namespace carousel::ringbus::cycle
