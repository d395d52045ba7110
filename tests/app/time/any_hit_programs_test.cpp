// Machines whose shader workers run a program for each any-hit call.
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/system/error.h"
#include "tests/app/time/timed_run.h"

namespace carousel::any_hit_programs_test {
namespace {

class AnyHitPrograms : public TimedRun {
 protected:
  static double of(const Json& r, const char* key) { return r["shading"]["programs"][key].get<double>(); }
  std::string refused(const std::string& machine, const std::vector<std::string>& sets = {}) {
    try {
      report(machine, sets);
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "";
  }
};

/// Leaves with alpha textures, whose calls a worker answers. The program of all other work takes a cycle.
std::string foliage(const std::string& shading, const std::string& any_hit = "") {
  return fmt::format(
      "scene: {{builtin: foliage, triangles: 200}}\nimage: {{width: 16, height: 10, samples: 1, max_depth: 2}}\n"
      "topology: {{resources: 2}}\nrays: {{slots_per_resource: 32}}\npackets: {{rays: 8}}\n"
      "testers: {{any_hit: shader}}\nshading: {{workers: 1, {}}}\n"
      "programs: {{shaders: {{other: {{program: ['load a, 1']}}{}}}}}\n",
      shading, any_hit.empty() ? "" : fmt::format(", own: {{program: [{}]}}", any_hit));
}

/// Instructions that wait for nothing.
std::string loads(int count) {
  std::string out;
  for (int i = 0; i < count; ++i) out += fmt::format("{}'load r{}, {}'", i > 0 ? ", " : "", i, i);
  return out;
}

// The calls of a packet run as many at once as there are lanes, N cycles each time, as the constant says.
TEST_F(AnyHitPrograms, OfNInstructionsTakeNCycles) {
  for (const auto& [count, lanes] : std::vector<std::pair<int, int>>{{1, 1}, {40, 1}, {40, 4}}) {
    SCOPED_TRACE(fmt::format("{} {}", count, lanes));
    // One vector at a time: the largest program has its own registers, and those of the ray.
    const int registers = lanes * (count + 9);
    const Json constant =
        report(foliage(fmt::format("lanes: {}, registers: {}, cycles_per_any_hit: {}, program: {{default: other, "
                                   "any_hit: constant}}",
                                   lanes, lanes * 10, count)));
    const Json run = report(
        foliage(fmt::format("lanes: {}, registers: {}, program: {{default: other, any_hit: own}}", lanes, registers),
                loads(count)));
    EXPECT_EQ(of(constant, "vectors_held"), 1);
    EXPECT_EQ(of(run, "vectors_held"), 1);
    EXPECT_EQ(run["engine"]["cycles"], constant["engine"]["cycles"]);
    EXPECT_EQ(run["digest"], constant["digest"]);
    EXPECT_EQ(of(constant, "any_hit_calls"), 0);
    EXPECT_EQ(run["shading"]["programs"]["any_hit_calls"], run["tests"]["any_hit"]["count"]);
    EXPECT_EQ(of(run, "simple"), of(constant, "simple") + count * of(run, "any_hit_calls"));
  }
}

// Whatever the machine, calls and hits are the same, each cycle of a vector has a cause, and no unit is charged.
TEST_F(AnyHitPrograms, HitsStayTheSame) {
  const std::string machine = foliage("lanes: 4, program: {default: other, any_hit: built_in}");
  const Json inlined = report(machine, {"testers.any_hit=inline", "energy.profile=n45"});
  const Json native = report(machine, {"engine.kind=native", "testers.any_hit=inline", "shading.lanes=1"});
  EXPECT_EQ(native["digest"], inlined["digest"]);
  for (const char* more :
       {"image.seed=1", "topology.shape=independent", "testers.simt.warp=8", "collections.traversal=treelet",
        "bvh.micromaps.states=four", "shading.instruction_cache.bytes=256", "shading.data_cache.bytes=2048",
        "rays.slots_per_resource=8"}) {
    SCOPED_TRACE(more);
    std::vector<std::string> sets{more, "energy.profile=n45"};
    if (std::string(more).starts_with("testers.simt")) sets.push_back("topology.shape=independent");
    const Json r = report(machine, sets);
    EXPECT_EQ(r["digest"], inlined["digest"]);
    EXPECT_EQ(r["shading"]["programs"]["any_hit_calls"], r["tests"]["any_hit"]["count"]);
    EXPECT_EQ(of(r, "vector_cycles"), of(r, "issued") + of(r, "operand_stalls") + of(r, "branch_stalls") +
                                          of(r, "trace_stalls") + of(r, "memory_stalls") + of(r, "instruction_stalls") +
                                          of(r, "issue_stalls"));
    EXPECT_GT(of(r, "texture"), 0);
    EXPECT_GT(r["memory"]["ray_data"]["texels_read"], 0);
    EXPECT_EQ(r["energy"]["parts"]["any_hit_lookups"]["joules"], 0);
  }
  EXPECT_GT(inlined["energy"]["parts"]["any_hit_lookups"]["joules"], 0);
}

// A call's program finds what the call is about: a mask with one texture, whatever kind of ray it is.
TEST_F(AnyHitPrograms, FindTheSurface) {
  const std::string by_ray = "program: {default: other, any_hit: own}";
  // Which calls there are depends on the order of tests, and so on the time of each.
  const auto asked_of = [&](const char* fact) {
    const Json r = report(foliage(by_ray, fmt::format("'if {}', 'mul a, hit, hit', 'end'", fact)));
    return std::pair{of(r, "product"), of(r, "any_hit_calls")};
  };
  for (const char* fact : {"hit", "alpha", "lookups"}) {
    const auto [products, calls] = asked_of(fact);
    EXPECT_EQ(products, calls) << fact;
    EXPECT_GT(calls, 0);
  }
  EXPECT_EQ(asked_of("emissive").first, 0);
  const auto [products, calls] = asked_of("shadow");
  EXPECT_GT(products, 0);
  EXPECT_LT(products, calls);
}

TEST_F(AnyHitPrograms, SendNoRays) {
  const std::string machine =
      foliage("program: {default: other, any_hit: own}", "'load a, 1', 'add b, a, a', 'trace b'");
  const std::string message = refused(machine);
  // At the word in the file.
  EXPECT_NE(message.find("machine.yaml:8:99: programs.shaders.own.program.2: an any-hit call sends no rays"),
            message.npos)
      << message;
  EXPECT_EQ(refused(machine, {"shading.program.any_hit=other", "shading.program.shadow=own"}), "");
  EXPECT_EQ(refused(machine, {"testers.any_hit=inline"}), "") << "no worker runs it";
}

TEST_F(AnyHitPrograms, AreNamed) {
  const std::string own = "'load a, 1'";
  EXPECT_NE(refused(foliage("program: other", own))
                .find("programs.shaders.own: nothing runs this program; expected a key of shading.program that names"),
            std::string::npos);
  EXPECT_NE(refused(foliage("program: {default: other, any_hit: owm}", own)).find("did you mean 'own'?"),
            std::string::npos);
  EXPECT_NE(refused(foliage("program: {default: other, any_hit: shader}", own))
                .find("programs.shaders, or built_in, or constant, found 'shader'; known are built_in, constant, "),
            std::string::npos)
      << "what alone may be constant says so";
  EXPECT_NE(refused(foliage("program: {default: other, miss: constant}")).find("found 'constant'"), std::string::npos);
  EXPECT_EQ(refused(foliage("program: {default: other, any_hit: constant}")), "");
}

}  // namespace
}  // namespace carousel::any_hit_programs_test
