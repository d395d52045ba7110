// The arithmetic, the way and the time of programs against answers by hand. tests/python/programs_test.py compares
// random programs with a second interpreter.
#include <cmath>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/program/compile.h"
#include "core/program/run.h"

namespace carousel::program_test {
namespace {

using testing::HasSubstr;

const Ray kRay{{1, 2, 3}, 0.5f, {4, 5, 6}, 7};

RayProgram compiled(const std::vector<std::string>& lines, const OpLatencies& latencies = {4, 4, 16, 2}) {
  ProgramFault fault;
  const auto program = compile_program(lines, {{"p", 0.1}}, latencies, fault);
  EXPECT_TRUE(program) << fault.line << ": " << fault.message;
  return program.value_or(RayProgram{});
}

/// The value that a register has at the end.
float value_of(std::vector<std::string> lines, const std::string& name) {
  lines.push_back("hit " + name + ", dx, dy, dz");
  const ProgramRun run = run_program(compiled(lines), kRay);
  EXPECT_EQ(run.hits, 1u);
  return run.hits > 0 ? run.hit[0].t : NAN;
}

ProgramFault fault_of(const std::vector<std::string>& lines) {
  ProgramFault fault;
  EXPECT_FALSE(compile_program(lines, {{"p", 0.1}}, {4, 4, 16, 2}, fault));
  return fault;
}

TEST(Program, RoundsEachInstructionOnce) {
  // (1 + 2^-12)^2 - (1 + 2^-11) is 2^-24: the product alone rounds it away.
  const std::vector<std::string> both{"load a, 1.000244140625", "load b, -1.00048828125"};
  const auto with = [&](std::initializer_list<std::string> more) {
    std::vector<std::string> lines = both;
    lines.insert(lines.end(), more);
    return lines;
  };
  EXPECT_EQ(value_of(with({"fma c, a, a, b"}), "c"), 0x1p-24f);
  EXPECT_EQ(value_of(with({"mul c, a, a", "add c, c, b"}), "c"), 0.0f);
  EXPECT_EQ(value_of({"load a, p"}, "a"), 0.1f);
  EXPECT_EQ(value_of({"div a, ox, oz"}, "a"), 1.0f / 3.0f);
  EXPECT_EQ(value_of({"sqrt a, oy"}, "a"), std::sqrt(2.0f));
}

TEST(Program, TellsWhatOfNumbersThatAreNone) {
  const std::vector<std::string> none{"load z, 0", "div n, z, z"};
  const auto with = [&](const std::string& line) {
    std::vector<std::string> lines = none;
    lines.push_back(line);
    return value_of(lines, "a");
  };
  EXPECT_EQ(with("min a, n, ox"), 1.0f);
  EXPECT_EQ(with("max a, n, ox"), 1.0f);
  EXPECT_EQ(with("eq a, n, n"), 0.0f);
  EXPECT_EQ(with("le a, n, n"), 0.0f);
  EXPECT_EQ(with("select a, n, ox, oy"), 1.0f) << "what is no number is not 0";
}

TEST(Program, GoesRoundALoopAsOftenAsItSays) {
  const std::vector<std::string> count{"load a, 0", "load one, 1", "loop 3", "loop 5", "add a, a, one", "end", "end"};
  EXPECT_EQ(value_of(count, "a"), 15.0f);
  EXPECT_EQ(value_of({"load a, 0", "load one, 1", "loop 9", "add a, a, one", "le b, oz, a", "break b", "end"}, "a"), 3);
  EXPECT_EQ(value_of({"lt b, ox, oy", "if b", "mov a, ox", "else", "mov a, oy", "end"}, "a"), 1.0f);
  EXPECT_EQ(value_of({"lt b, oy, ox", "if b", "mov a, ox", "else", "mov a, oy", "end"}, "a"), 2.0f);
  const ProgramRun run = run_program(compiled({"hit ox, dx, dy, dz", "stop", "hit oy, dx, dy, dz"}), kRay);
  EXPECT_EQ(run.hits, 1u);
}

TEST(Program, KeepsTheFirstHitsOfATest) {
  const ProgramRun run =
      run_program(compiled({"load a, 0", "load one, 1", "loop 20", "add a, a, one", "hit a, dx, dy, dz", "end"}), kRay);
  ASSERT_EQ(run.hits, kMostProgramHits);
  EXPECT_EQ(run.hit[kMostProgramHits - 1].t, 8.0f);
}

TEST(Program, TakesTheTimeOfItsDependences) {
  const auto cycles = [](std::vector<std::string> lines) {
    lines.push_back("hit tmin, dx, dy, dz");
    return run_program(compiled(lines), kRay).cycles;
  };
  EXPECT_EQ(cycles({}), 1u);
  EXPECT_EQ(cycles({"mul a, ox, ox", "mul b, oy, oy"}), 3u) << "one a cycle";
  EXPECT_EQ(cycles({"mul a, ox, ox", "mul b, a, ox"}), 4u + 1 + 1) << "the second waits for the first";
  EXPECT_EQ(cycles({"mul a, ox, ox", "mul b, ox, a"}), 4u + 1 + 1);
  EXPECT_EQ(cycles({"mul a, ox, ox", "fma b, ox, oy, a"}), 4u + 1 + 1);
  EXPECT_EQ(cycles({"div a, ox, oy", "mov a, ox"}), 16u + 1 + 1) << "as it writes the same register";
  EXPECT_EQ(cycles({"div a, ox, oy", "add b, a, a"}), 16u + 1 + 1);
  EXPECT_EQ(cycles({"loop 3", "mul a, ox, ox", "end"}), 2u + 3 + 2 + 1 + 2 + 1 + 2 + 1);
  EXPECT_EQ(cycles({"lt a, ox, oy", "if a", "end"}), 4u + 2 + 1);
}

TEST(Program, IsRefusedWithTheWordThatIsWrong) {
  const std::string hit = "hit tmin, dx, dy, dz";
  EXPECT_THAT(fault_of({"mull a, ox, ox", hit}).message, HasSubstr("did you mean 'mul'?"));
  const ProgramFault unset = fault_of({"if ox", "mov a, oy", "end", "add b, ox, a", hit});
  EXPECT_EQ(unset.line, 3u);
  EXPECT_EQ(unset.column, 11u);
  EXPECT_THAT(unset.message, HasSubstr("not set on every way"));
  EXPECT_THAT(fault_of({"loop 65536", "loop 65536", "mov a, ox", "end", "end", hit}).message,
              HasSubstr("smaller bounds"));
  EXPECT_THAT(fault_of({"loop 0", "end", hit}).message, HasSubstr("expected an integer from 1 to 65536"));
  EXPECT_THAT(fault_of({}).message, HasSubstr("found none"));
  EXPECT_THAT(fault_of({"load a, 1e39", hit}).message, HasSubstr("expected a number"));
  EXPECT_THAT(fault_of({"else", hit}).message, HasSubstr("expected an if before this else"));
  EXPECT_THAT(fault_of({"hit tmin, dx, dy"}).message, HasSubstr("expected 4 operands of hit, found 3"));
}

TEST(Program, HoldsNoMoreThanAUnitDoes) {
  std::vector<std::string> lines;
  for (int i = 0; i < 57; ++i) lines.push_back("mov r" + std::to_string(i) + ", ox");
  EXPECT_THAT(fault_of(lines).message, HasSubstr("64 registers at most"));
  lines.assign(4097, "mov a, ox");
  const ProgramFault long_one = fault_of(lines);
  EXPECT_THAT(long_one.message, HasSubstr("4096 instructions at most"));
  EXPECT_EQ(long_one.line, 4096u);
  EXPECT_EQ(long_one.column, 0u);
}

}  // namespace
}  // namespace carousel::program_test
