// Which reported hits of a program count.
#include "accel/structure/program_hits.h"

#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "core/numeric/octahedral.h"
#include "core/program/compile.h"

namespace carousel::accel::program_hits_test {
namespace {

RayProgram reports(const std::vector<std::string>& lines) {
  ProgramFault fault;
  const auto program = compile_program(lines, {}, {4, 4, 16, 2}, fault);
  EXPECT_TRUE(program) << fault.message;
  return program.value_or(RayProgram{});
}

Aabb unit_box() {
  Aabb box;
  box.extend(Vec3(-1));
  box.extend(Vec3(1));
  return box;
}

/// The distances that count of hits at 1 to 5, of a ray that is in the box from 2 to 4.
std::vector<float> counted(const Ray& ray, const std::string& normal = "zero, zero, one") {
  const RayProgram program =
      reports({"load zero, 0", "load one, 1", "mov t, zero", "loop 5", "add t, t, one", "hit t, " + normal, "end"});
  const ProgramHits hits = program_hits(program, unit_box(), ray, nullptr);
  std::vector<float> out;
  for (std::size_t k = 0; k < hits.count; ++k) out.push_back(hits.hit[k].t);
  return out;
}

const Ray kThrough{{0, 0, -3}, 0, {0, 0, 1}, kInfinity};

TEST(ProgramHits, LieInTheBounds) {
  EXPECT_EQ(counted(kThrough), (std::vector<float>{2, 3, 4}));
  EXPECT_TRUE(counted({{1.1f, 0, -3}, 0, {0, 0, 1}, kInfinity}).empty());
}

TEST(ProgramHits, LieInTheRangeOfTheRay) {
  EXPECT_EQ(counted({{0, 0, -3}, 2.5f, {0, 0, 1}, 3.5f}), std::vector<float>{3});
  EXPECT_EQ(counted({{0, 0, -3}, 2, {0, 0, 1}, 4}), (std::vector<float>{2, 3, 4}));
}

TEST(ProgramHits, HaveANormal) {
  EXPECT_TRUE(counted(kThrough, "zero, zero, zero").empty());
  const RayProgram none = reports({"load three, 3", "load zero, 0", "div n, zero, zero", "hit three, n, zero, three"});
  EXPECT_EQ(program_hits(none, unit_box(), kThrough, nullptr).count, 0u);
}

TEST(ProgramHits, TellTheSideAndTheNormal) {
  const RayProgram program = reports({"load three, 3", "load zero, 0", "neg down, three", "hit three, zero, zero, down",
                                      "hit three, zero, three, three", "hit three, three, zero, zero"});
  const ProgramHits hits = program_hits(program, unit_box(), kThrough, nullptr);
  ASSERT_EQ(hits.count, 3u);
  EXPECT_EQ(hits.hit[0].facing, 1);
  EXPECT_EQ(hits.hit[1].facing, -1);
  EXPECT_EQ(hits.hit[2].facing, 0);
  const DVec3 normal = from_octahedral(hits.hit[1].where.x, hits.hit[1].where.y);
  EXPECT_NEAR(normal.y, 0.70710678, 1e-6);
  EXPECT_NEAR(normal.z, 0.70710678, 1e-6);
}

TEST(ProgramHits, CountTheWork) {
  IntersectionCounts counts;
  const RayProgram program = reports({"mul a, dx, dx", "div a, a, dz", "if a", "end", "hit tmin, dx, dy, dz"});
  program_hits(program, unit_box(), kThrough, &counts);
  program_hits(program, unit_box(), kThrough, &counts);
  EXPECT_EQ(counts.programs, 2u);
  EXPECT_EQ(counts.program_cycles, 2u * (4 + 16 + 2 + 1));
  EXPECT_EQ(counts.simple_instructions, 2u);
  EXPECT_EQ(counts.product_instructions, 2u);
  EXPECT_EQ(counts.divide_instructions, 2u);
  EXPECT_EQ(counts.branch_instructions, 2u);
}

}  // namespace
}  // namespace carousel::accel::program_hits_test
