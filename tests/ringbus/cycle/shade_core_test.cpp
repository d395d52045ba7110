// Shader workers that run programs, against times by hand.
#include "ringbus/cycle/shading/programs/shade_core.h"

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/program/compile.h"

namespace carousel::shade_core_test {
namespace {

using ringbus::Cycle;
using ringbus::kNever;
using ringbus::cycle::ProgramMemory;
using ringbus::cycle::ProgramRead;
using ringbus::cycle::ShadeCore;

constexpr OpLatencies kLatencies{4, 4, 16, 2, 0, 8, 5};

/// The programs, by kind of work.
ShadePrograms compiled(const std::vector<std::vector<std::string>>& texts) {
  ShadePrograms out;
  for (const std::vector<std::string>& lines : texts) {
    ProgramFault fault;
    const auto program = compile_program(lines, {}, kLatencies, fault, kShaderUse);
    EXPECT_TRUE(program) << fault.line << ": " << fault.message;
    out.of_kind[out.programs.size()] = static_cast<std::uint32_t>(out.programs.size());
    out.address.push_back(out.store_bytes);
    out.programs.push_back(program.value_or(RayProgram{}));
    out.store_bytes += 1024;
  }
  return out;
}

ShadeCore::Ray ray(std::initializer_list<std::pair<ShadeFact, float>> facts, std::uint32_t kind = 0) {
  ShadeCore::Ray out{kind};
  for (const auto& [fact, value] : facts) out.facts[fact] = value;
  return out;
}

/// Answers each read after a constant time.
struct Memory final : ProgramMemory {
  std::uint64_t line_bytes() const override { return 64; }
  void read(ShadeData, const DataRead& data, const ProgramRead& by, Cycle now) override {
    asked.push_back(data);
    answers.push_back({now + latency, by});
  }
  Cycle latency = 20;
  std::vector<DataRead> asked;
  std::vector<std::pair<Cycle, ProgramRead>> answers;
};

/// A worker and its memory.
class Worker {
 public:
  Worker(ShadePrograms programs, std::size_t vectors, std::size_t lanes, InstructionCacheConfig cache = {})
      : programs_(std::move(programs)), core_(programs_, cache, 0, vectors, lanes) {}

  void begin(std::size_t at, std::vector<ShadeCore::Ray> rays, Cycle now) { core_.begin(at, std::move(rays), now); }
  Cycle occupy(Cycle cycles, Cycle now) { return core_.occupy(cycles, now); }
  /// Runs until all vectors have ended; returns when, by place.
  std::vector<Cycle> run(std::size_t vectors) {
    std::vector<Cycle> ends(vectors, kNever);
    while (true) {
      Cycle now = core_.next();
      for (const auto& [at, by] : memory.answers) now = std::min(now, at);
      if (now == kNever) break;
      std::erase_if(memory.answers, [&](const auto& answer) {
        if (answer.first != now) return false;
        core_.answer(answer.second, now);
        return true;
      });
      std::vector<std::size_t> ended;
      core_.step(now, &memory, ended);
      for (const std::size_t at : ended) ends[at] = now;
    }
    const ShadeProgramCounts& c = core_.counts();
    EXPECT_EQ(c.vector_cycles, c.issued + c.stalls());
    return ends;
  }
  const ShadeCore& core() const { return core_; }
  Memory memory;

 private:
  ShadePrograms programs_;
  ShadeCore core_;
};

using Ends = std::vector<Cycle>;

TEST(ShadeCore, ARayTakesTheLatenciesOfItsProgram) {
  // load in 0, mul in 4, div in 8, add in 24.
  Worker worker(compiled({{"load a, 2", "mul b, a, a", "div c, b, a", "add d, c, c"}}), 1, 1);
  worker.begin(0, {ray({})}, 100);
  EXPECT_EQ(worker.run(1), Ends{125});
  const ShadeProgramCounts& c = worker.core().counts();
  EXPECT_EQ(c.issued, 4u);
  EXPECT_EQ(c.operand_stalls, 3u + 3 + 15);
  EXPECT_EQ(c.simple, 2u);
  EXPECT_EQ(c.product, 1u);
  EXPECT_EQ(c.divide, 1u);
}

const std::vector<std::string> kParting{"if hit", "load a, 1", "else", "load b, 1", "load b, 2", "end", "load c, 1"};

TEST(ShadeCore, LanesThatPartTakeBothWays) {
  const auto ends = [](std::vector<ShadeCore::Ray> rays) {
    Worker worker(compiled({kParting}), 1, 4);
    worker.begin(0, std::move(rays), 0);
    return worker.run(1)[0];
  };
  const ShadeCore::Ray hit = ray({{ShadeFact::kHit, 1}}), miss = ray({});
  EXPECT_EQ(ends({hit}), 2u + 1 + 2 + 1);                // if, load, else, load
  EXPECT_EQ(ends({miss}), 2u + 4 + 1 + 1);               // if, load, and when its value has come load; load
  EXPECT_EQ(ends({hit, hit, hit}), ends({hit}));         // in step
  EXPECT_EQ(ends({hit, miss}), 2u + 1 + 2 + 4 + 1 + 1);  // both, and the last together
  Worker worker(compiled({kParting}), 1, 4);
  worker.begin(0, {miss, hit, miss}, 0);
  EXPECT_EQ(worker.run(1)[0], ends({hit, miss}));
  const ShadeProgramCounts& c = worker.core().counts();
  EXPECT_EQ(c.branch, 3u + 1);          // if by all, else by one
  EXPECT_EQ(c.simple, 1u + 2 * 2 + 3);  // each lane its own
  EXPECT_EQ(c.issued, 6u);
}

TEST(ShadeCore, LoopsGoOnUntilTheLastLaneLeaves) {
  // As many rounds as lights: each 0 + 4 (sub, lt), then break and end.
  const std::vector<std::string> lines{"load one, 1",   "load zero, 0",   "mov n, lights", "loop 8",
                                       "sub n, n, one", "lt out, n, one", "break out",     "end"};
  const auto end = [&](std::vector<float> lights) {
    Worker worker(compiled({lines}), 1, 8);
    std::vector<ShadeCore::Ray> rays;
    for (const float n : lights) rays.push_back(ray({{ShadeFact::kLights, n}}));
    worker.begin(0, std::move(rays), 0);
    return worker.run(1)[0];
  };
  // loads in 0, 1, mov in 2, loop in 3 to 5; sub in 6, when n has come; lt in 10, break in 14 to 16.
  EXPECT_EQ(end({1}), 16u);
  EXPECT_EQ(end({3}), 16u + 2 * (2 + 4 + 4 + 2));  // end, sub, lt, break
  EXPECT_EQ(end({1, 3, 2}), end({3}));
  EXPECT_EQ(end({99}), 16u + 7 * 12 + 2) << "the bound of the loop, and its last end";
}

TEST(ShadeCore, InstructionsComeThroughTheCache) {
  // Two lines of two instructions. Each load writes a register of its own.
  const InstructionCacheConfig small{32, 16, 10};
  Worker straight(compiled({{"load a, 1", "load b, 1", "load c, 1", "load d, 1", "load e, 1", "load f, 1"}}), 1, 1,
                  small);
  straight.begin(0, {ray({})}, 0);
  EXPECT_EQ(straight.run(1), Ends{3 * (10 + 2)});
  EXPECT_EQ(straight.core().instruction_misses(), 3u);
  EXPECT_EQ(straight.core().instruction_bytes(), 48u);
  EXPECT_EQ(straight.core().counts().instruction_stalls, 30u);
  // loop and load in line 0, load and end in line 1: there from the first round on.
  const std::vector<std::string> loop{"loop 3", "load b, 1", "load c, 1", "end"};
  Worker fits(compiled({loop}), 1, 1, small);
  fits.begin(0, {ray({})}, 0);
  EXPECT_EQ(fits.run(1), Ends{10 + 2 + 1 + 10 + 1 + 2 + 2 * (1 + 1 + 2)});
  EXPECT_EQ(fits.core().instruction_misses(), 2u);
  // With one line of two instructions each round misses twice.
  Worker thrashes(compiled({loop}), 1, 1, {16, 16, 10});
  thrashes.begin(0, {ray({})}, 0);
  EXPECT_EQ(thrashes.run(1), Ends{12 + 1 + 13 + 2 * (11 + 13)});
  EXPECT_EQ(thrashes.core().instruction_misses(), 6u);
}

TEST(ShadeCore, ALineThatWasReplacedServesThoseWhoWaitForIt) {
  Worker worker(compiled({{"load a, 1"}, {"load b, 1"}}), 2, 1, {64, 64, 40});
  worker.begin(0, {ray({}, 0)}, 0);
  worker.begin(1, {ray({}, 1)}, 0);
  EXPECT_EQ(worker.run(2), (Ends{41, 42}));
  EXPECT_EQ(worker.core().instruction_misses(), 2u);
}

TEST(ShadeCore, VectorsShareALineThatIsUnderWay) {
  Worker worker(compiled({{"load a, 1", "load b, 1"}}), 2, 1, {1024, 64, 10});
  worker.begin(0, {ray({})}, 0);
  worker.begin(1, {ray({})}, 4);
  EXPECT_EQ(worker.run(2), (Ends{13, 14}));  // issues in 10, 12 and 11, 13
  EXPECT_EQ(worker.core().instruction_misses(), 1u);
}

TEST(ShadeCore, VectorsHideEachOthersLatencies) {
  const std::vector<std::string> lines{"load a, 1", "add b, a, a", "add c, b, b"};
  Worker worker(compiled({lines}), 3, 1);
  for (std::size_t i = 0; i < 3; ++i) worker.begin(i, {ray({})}, 0);
  EXPECT_EQ(worker.run(3), (Ends{9, 10, 11}));
  EXPECT_EQ(worker.core().counts().issue_stalls, 0u + 1 + 2);
  EXPECT_EQ(worker.core().counts().operand_stalls, 3u * 6);
}

TEST(ShadeCore, OtherJobsHoldTheWorkerUp) {
  Worker worker(compiled({{"load a, 1", "load b, 1"}}), 1, 1);
  EXPECT_EQ(worker.occupy(10, 5), 15u);
  EXPECT_EQ(worker.occupy(10, 6), 25u);
  worker.begin(0, {ray({})}, 7);
  EXPECT_EQ(worker.run(1), Ends{27});
  EXPECT_EQ(worker.core().counts().issue_stalls, 18u);
  EXPECT_EQ(worker.core().issuing(), 10u + 10 + 2);
}

TEST(ShadeCore, ReadsAreWaitedForWhereTheyAreUsed) {
  const std::vector<std::string> lines{"read a, material", "load b, 1", "mov c, a",
                                       "texture d, c",     "trace d",   "load e, 1"};
  const auto textured = [] {
    ShadeCore::Ray out = ray({});
    out.facts.material = {{0, 128}};
    out.facts.lookups = {{{4096, 4}, {4100, 4}, {8192, 4}}};
    return out;
  };
  Worker worker(compiled({lines}), 1, 2);
  worker.begin(0, {textured(), textured()}, 0);
  // read in 0, load in 1, mov in 20, texture in 24; texels in 44, filtered in 52: trace to 57, load.
  EXPECT_EQ(worker.run(1), Ends{58});
  const ShadeProgramCounts& c = worker.core().counts();
  EXPECT_EQ(c.memory_stalls, 18u + 27);
  EXPECT_EQ(c.trace_stalls, 4u);
  EXPECT_EQ(c.read, 2u);
  // The rays read the same material, and texels of two lines.
  EXPECT_EQ(worker.memory.asked, (std::vector<DataRead>{{0, 64}, {64, 64}, {4096, 64}, {8192, 64}}));
  EXPECT_EQ(c.data_reads, 4u);
}

TEST(ShadeCore, RegistersAreFreeWhenReadsHaveCome) {
  Worker worker(compiled({{"read a, vertices", "load b, 1"}}), 1, 1);
  ShadeCore::Ray hit = ray({});
  hit.facts.vertices = {{0, 32}, {640, 32}, {960, 32}};
  worker.begin(0, {hit}, 0);
  EXPECT_EQ(worker.run(1), Ends{20});
  EXPECT_EQ(worker.core().counts().memory_stalls, 18u);
}

TEST(ShadeCore, ProgramsOfAVectorTakeTurns) {
  const std::vector<std::string> two{"load a, 1", "load b, 1"}, three{"load a, 1", "load b, 1", "load c, 1"};
  Worker worker(compiled({two, three}), 1, 2);
  worker.begin(0, {ray({}, 1), ray({}, 0), ray({}, 1)}, 0);
  EXPECT_EQ(worker.run(1), Ends{3 + 2});
  EXPECT_EQ(worker.core().vectors().runs, 2u);
  EXPECT_EQ(worker.core().vectors().rays, 3u);
  Worker camera(compiled({two}), 1, 2);  // five rays for two lanes
  camera.begin(0, std::vector<ShadeCore::Ray>(5, ShadeCore::Ray{kCameraKind}), 0);
  EXPECT_EQ(camera.run(1), Ends{6});
  EXPECT_EQ(camera.core().vectors().vectors, 0u) << "camera rays are not completed rays";
}

}  // namespace
}  // namespace carousel::shade_core_test
