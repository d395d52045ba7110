// The data cache and the TLB of a shader worker, against times by hand.
#include "ringbus/cycle/shading/programs/data_path.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

namespace carousel::data_path_test {
namespace {

using ringbus::Cycle;
using ringbus::kNever;
using ringbus::cycle::DataPath;
using ringbus::cycle::ProgramMemory;
using ringbus::cycle::ProgramRead;

/// Answers each read after a hundred cycles.
struct Memory final : ProgramMemory {
  std::uint64_t line_bytes() const override { return 64; }
  void read(ShadeData what, const DataRead& data, const ProgramRead& by, Cycle now) override {
    asked.push_back({what, data, now});
    answers.push_back({now + 100, by});
  }
  struct Asked {
    ShadeData what;
    DataRead data;
    Cycle at;
  };
  std::vector<Asked> asked;
  std::vector<std::pair<Cycle, ProgramRead>> answers;
};

struct Read {
  Cycle at;
  std::uint64_t line;
  ShadeData what = ShadeData::kVertices;
};

class Path {
 public:
  Path(const DataCacheConfig& cache, const TranslationConfig& pages) : path_(cache, pages, 0, memory) {}

  /// Makes the reads, in order of time; returns when the data of each is there.
  std::vector<Cycle> run(const std::vector<Read>& reads) {
    std::vector<Cycle> ends(reads.size(), kNever);
    std::size_t made = 0;
    for (;;) {
      Cycle now = std::min(made < reads.size() ? reads[made].at : kNever, path_.next());
      for (const auto& [at, by] : memory.answers) now = std::min(now, at);
      if (now == kNever) return ends;
      // An answer may have the path read on.
      const auto answers = memory.answers;
      std::erase_if(memory.answers, [now](const auto& answer) { return answer.first == now; });
      for (const auto& [at, by] : answers) {
        if (at != now) continue;
        if (by.to == ProgramRead::To::kRegister)
          ends[by.vector] = now;
        else
          path_.take(by, now);
      }
      for (; made < reads.size() && reads[made].at == now; ++made)
        path_.read(reads[made].what, {64 * reads[made].line, 64}, {.vector = static_cast<std::uint32_t>(made)}, now);
      path_.step(now, [&](const ProgramRead& by) { ends[by.vector] = now; });
    }
  }
  const ShadeDataCounts& counts() const { return path_.counts(); }
  Memory memory;

 private:
  DataPath path_;
};

using Ends = std::vector<Cycle>;

TEST(DataPath, AMissTakesTheLookupAndTheMemoryAndAHitTheLookup) {
  Path path({.bytes = 256, .ways = 2, .latency_cycles = 4, .line_bytes = {}}, {});
  EXPECT_EQ(path.run({{10, 0}, {200, 0}, {200, 1}}), (Ends{114, 204, 201 + 104})) << "one lookup a cycle";
  EXPECT_EQ(path.counts(), (ShadeDataCounts{.lines = 3, .hits = 1, .misses = 2}));
}

TEST(DataPath, ALineUnderWayIsNotAskedForAgain) {
  Path path({.bytes = 256, .ways = 2, .latency_cycles = 4, .line_bytes = {}}, {});
  EXPECT_EQ(path.run({{10, 0}, {60, 0}, {112, 0}}), (Ends{114, 114, 116})) << "known after a lookup, as a hit is";
  EXPECT_EQ(path.memory.asked.size(), 1u);
  EXPECT_EQ(path.counts(), (ShadeDataCounts{.lines = 3, .hits = 0, .misses = 1}));
}

// Two sets of two lines: lines 0, 2 and 4 share one.
TEST(DataPath, TheLineUsedLeastRecentlyGoes) {
  Path path({.bytes = 256, .ways = 2, .latency_cycles = 0, .line_bytes = {}}, {});
  path.run({{0, 0}, {1000, 2}, {2000, 0}, {3000, 4}, {4000, 0}, {5000, 2}});
  EXPECT_EQ(path.counts(), (ShadeDataCounts{.lines = 6, .hits = 2, .misses = 4})) << "2 made room for 4";
}

TEST(DataPath, TablesAreApart) {
  Path path({.bytes = 256, .ways = 2, .latency_cycles = 0, .line_bytes = {}}, {});
  path.run({{0, 0, ShadeData::kMaterial}, {1000, 0, ShadeData::kTexels}, {2000, 0, ShadeData::kMaterial}});
  EXPECT_EQ(path.counts(), (ShadeDataCounts{.lines = 3, .hits = 1, .misses = 2}));
}

// Pages of 4096 bytes leave 36 bits, four levels of nine; those of 2 MiB 27, three levels.
TEST(DataPath, AWalkReadsALevelAfterAnother) {
  for (const auto& [bytes, levels] : {std::pair{4096, 4u}, {1 << 21, 3u}, {1 << 30, 2u}}) {
    Path path({}, {.page_bytes = bytes, .entries = 2});
    EXPECT_EQ(path.run({{10, 0}, {2000, 1}}), (Ends{10 + 100 * (levels + 1), 2100})) << bytes;
    ASSERT_EQ(path.memory.asked.size(), levels + 2);
    for (std::uint32_t level = 0; level < levels; ++level) {
      EXPECT_EQ(path.memory.asked[level].what, ShadeData::kPages);
      EXPECT_EQ(path.memory.asked[level].data.bytes, 8u);
      EXPECT_EQ(path.memory.asked[level].data.offset >> 44, level);
    }
    // The last entry is that of the page: vertices are the second table, of 2^40 bytes.
    EXPECT_EQ(path.memory.asked[levels - 1].data.offset & ((std::uint64_t{1} << 44) - 1),
              8 * ((std::uint64_t{1} << 40) / static_cast<std::uint64_t>(bytes)));
    EXPECT_EQ(path.counts(), (ShadeDataCounts{.pages = 2, .page_misses = 1, .walks = 1, .walk_reads = levels}));
  }
}

// A page has 64 lines. The walker goes for one page at a time, and for each once.
TEST(DataPath, WalksWaitForEachOther) {
  Path path({}, {.page_bytes = 4096, .entries = 2});
  EXPECT_EQ(path.run({{0, 0}, {0, 64}, {0, 1}, {0, 65}}), (Ends{500, 900, 501, 901}))
      << "what has waited enters one a cycle";
  EXPECT_EQ(path.counts(), (ShadeDataCounts{.pages = 4, .page_misses = 4, .walks = 2, .walk_reads = 8}));
}

TEST(DataPath, ThePageUsedLeastRecentlyGoes) {
  Path path({}, {.page_bytes = 4096, .entries = 2});
  path.run({{0, 0}, {1000, 64}, {2000, 0}, {3000, 128}, {4000, 0}, {5000, 64}});
  EXPECT_EQ(path.counts(), (ShadeDataCounts{.pages = 6, .page_misses = 4, .walks = 4, .walk_reads = 16}));
}

TEST(DataPath, ALineWaitsForItsPageAndThenForTheCache) {
  Path path({.bytes = 256, .ways = 2, .latency_cycles = 4, .line_bytes = 128}, {.page_bytes = 4096, .entries = 2});
  EXPECT_EQ(path.run({{0, 0}, {1000, 0}}), (Ends{400 + 4 + 100, 1004}));
  EXPECT_EQ(path.memory.asked.back().data.bytes, 128u);
}

}  // namespace
}  // namespace carousel::data_path_test
