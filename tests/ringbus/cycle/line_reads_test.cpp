// The port through which warps read lines: those that are read ahead take what is left of it, and are told apart.
#include "ringbus/cycle/tile/warps/line_reads.h"

#include <optional>

#include <gtest/gtest.h>

#include "tests/ringbus/time/loose_channel.h"

namespace carousel::ringbus::cycle {
namespace {

constexpr std::uint64_t kLine = 64;

/// A port of two lines a cycle, at a buffer of `kib` whose cache the test plays.
struct Reads {
  explicit Reads(std::int64_t kib = 16) {
    config.shape_buffer_kib = kib;
    SidePorts ports;
    ports.fetch = &requests;
    ports.fetched = &answers;
    buffer.emplace(config, LinkConfig{}, ports);
    of.emplace(*buffer, config, 2);
  }
  static ShapeSpan lines(std::uint64_t first, std::uint32_t count) {
    return {first * kLine, count * static_cast<std::uint32_t>(kLine)};
  }
  /// A task of its own asks for lines.
  void ask(std::uint64_t first, std::uint32_t count) {
    of->ask(next_task++, {lines(first, count), {}});
    of->end_group();
  }
  /// A cycle of the port. The lines that were asked for by others than tasks.
  std::uint64_t cycle(Cycle now) {
    const std::uint64_t before = of->lines_ahead();
    of->read(now);
    of->read_idle(now);
    return of->lines_ahead() - before;
  }
  /// All that has been asked for comes.
  void answer(Cycle now) {
    while (requests.next() != kNever) answers.send(now, {requests.take().tag});
    buffer->take_answers(now);
    of->take_ready(now);
    of->here().clear();
  }

  MemoryConfig config;
  LooseChannel<FetchRequest> requests;
  LooseChannel<FetchAnswer> answers;
  std::optional<ShapeBuffer> buffer;
  std::optional<LineReads> of;
  std::uint32_t next_task = 0;
};

TEST(LineReads, ReadAheadWhatOthersLeaveOfThePort) {
  Reads r;
  r.ask(0, 3);
  r.of->read_ahead(Reads::lines(100, 4));
  EXPECT_EQ(r.cycle(0), 0u);  // two of the three lines
  EXPECT_EQ(r.cycle(1), 1u);  // the third one, and one ahead
  EXPECT_EQ(r.cycle(2), 2u);
  EXPECT_TRUE(r.of->reads_ahead());
  EXPECT_EQ(r.cycle(3), 1u);
  EXPECT_FALSE(r.of->reads_ahead());
  EXPECT_FALSE(r.of->idle());  // the three lines have not come
  r.answer(100);
  EXPECT_TRUE(r.of->idle());
  EXPECT_EQ(r.of->read(), 3u);
}

TEST(LineReads, ALineThatIsThereTakesThePortAndIsNotRead) {
  Reads r;
  r.ask(0, 2);
  r.cycle(0);
  r.answer(100);
  r.of->read_ahead(Reads::lines(0, 3));
  EXPECT_EQ(r.cycle(101), 0u);
  EXPECT_EQ(r.cycle(102), 1u);
  EXPECT_EQ(r.buffer->counts().misses, 3u);
}

TEST(LineReads, TellWhichLinesThatWereReadAheadAreUsed) {
  Reads r;
  r.ask(0, 1);
  r.of->read_ahead(Reads::lines(0, 3));
  EXPECT_EQ(r.cycle(0), 0u);  // somebody has asked for the first line, which is on its way
  EXPECT_EQ(r.cycle(1), 2u);
  r.ask(1, 1);  // on its way
  r.cycle(2);
  EXPECT_EQ(r.of->used_ahead(), 1u);
  r.answer(100);
  r.ask(1, 2);  // the first of them has been used
  r.cycle(101);
  EXPECT_EQ(r.of->used_ahead(), 2u);
  EXPECT_EQ(r.of->lines_ahead(), 2u);
}

TEST(LineReads, ALineThatIsGoneAgainIsNotUsed) {
  Reads r(1);  // 16 lines
  r.of->read_ahead(Reads::lines(0, 1));
  EXPECT_EQ(r.cycle(0), 1u);
  r.answer(100);
  for (std::uint64_t line = 100; line < 116; line += 2) {
    r.ask(line, 2);
    r.cycle(101 + line);
  }
  r.ask(0, 1);  // waits for room: all lines are on their way
  r.cycle(300);
  EXPECT_EQ(r.of->used_ahead(), 0u);
  r.answer(400);
  r.answer(500);
  EXPECT_TRUE(r.of->idle());
}

}  // namespace
}  // namespace carousel::ringbus::cycle
