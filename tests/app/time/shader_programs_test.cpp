// Whole machines whose shader workers run programs.
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "tests/app/time/timed_run.h"

namespace carousel::shader_programs_test {
namespace {

class ShaderPrograms : public TimedRun {
 protected:
  static std::uint64_t cycles(const Json& r) { return r["engine"]["cycles"].get<std::uint64_t>(); }
  /// Rays per kilocycle that the workers would allow.
  static double bound(const Json& r) {
    for (const Json& of : r["bound"]["classes"])
      if (of["name"] == "shading") return of["rays_per_kilocycle"];
    return 0;
  }
};

std::string machine(const std::string& shading, const std::string& program = "") {
  return fmt::format(
      "scene: {{builtin: terrain, triangles: 300}}\nimage: {{width: 12, height: 9, samples: 1, max_depth: 3}}\n"
      "topology: {{resources: 2}}\nrays: {{slots_per_resource: 32}}\npackets: {{rays: 8}}\n"
      "shading: {{workers: 2, {}}}\n{}",
      shading, program.empty() ? "" : fmt::format("programs: {{shaders: {{own: {{program: [{}]}}}}}}\n", program));
}

/// Instructions that wait for nothing.
std::string loads(int count) {
  std::string out;
  for (int i = 0; i < count; ++i) out += fmt::format("{}'load r{}, {}'", i > 0 ? ", " : "", i, i);
  return out;
}

// A program of independent instructions takes as many cycles, as a constant does. With one worker, since several are
// not chosen in the same order.
TEST_F(ShaderPrograms, OfNInstructionsTakeNCycles) {
  const std::vector<std::string> one{"shading.workers=1"};
  for (const auto& [count, lanes] : std::vector<std::pair<int, int>>{{1, 3}, {30, 1}, {50, 3}}) {
    SCOPED_TRACE(fmt::format("{} {}", count, lanes));
    const std::string same = fmt::format("lanes: {}, sort: shader", lanes);
    const Json constant = report(
        machine(fmt::format("{}, cycles_per_shade: {}, cycles_per_lookup: 0, products_per_cycle: 0", same, count)),
        one);
    const int registers = lanes * (count + 9) * 2 - 1;  // for one vector
    const Json run =
        report(machine(fmt::format("{}, registers: {}, program: own", same, registers), loads(count)), one);
    EXPECT_EQ(run["digest"], constant["digest"]);
    EXPECT_EQ(run["shading"]["programs"]["vectors_held"], 1);
    EXPECT_EQ(cycles(run), cycles(constant));
    EXPECT_DOUBLE_EQ(run["shading"]["utilisation"].get<double>(), constant["shading"]["utilisation"].get<double>());
  }
}

// Whatever the machine, each cycle of a vector has a cause, and each instruction its joules.
TEST_F(ShaderPrograms, TotalsClose) {
  for (const char* more : {"", "lanes: 8, sort: shader, ", "instruction_cache: {bytes: 512, miss_cycles: 9}, ",
                           "lanes: 4, registers: 1024, "}) {
    SCOPED_TRACE(more);
    const Json r =
        report(machine(std::string(more) + "program: built_in"), {"energy.profile=n45", "scene={builtin: cornell}"});
    const Json& p = r["shading"]["programs"];
    const auto of = [&](const char* key) { return p[key].get<double>(); };
    EXPECT_EQ(of("vector_cycles"), of("issued") + of("operand_stalls") + of("branch_stalls") + of("trace_stalls") +
                                       of("memory_stalls") + of("instruction_stalls") + of("issue_stalls"));
    const double simple = of("simple") + of("read") + of("trace");
    // A word of 8 bytes from the store behind an instruction cache: 20 pJ with 32 KiB, 100 with 1024, a line in a
    // logarithmic plot between.
    const double word = 20 * std::pow(5, std::log(of("store_bytes") / 1024 / 32) / std::log(32));
    EXPECT_GT(of("store_bytes"), 32 * 1024);
    EXPECT_EQ(of("instruction_bytes") > 0, std::string_view(more).starts_with("instruction_cache"));
    const double expected = 1e-12 * (5.9 * (simple + of("branch")) + 9.6 * of("product") + 23.4 * of("divide") +
                                     word * of("instruction_bytes") / 8);
    EXPECT_NEAR(r["energy"]["parts"]["shades"]["joules"].get<double>() / expected, 1, 1e-5);
    EXPECT_GT(of("memory_stalls"), 0);
    const Json& data = r["memory"]["ray_data"];
    EXPECT_GT(data["materials_read"], 0);
    EXPECT_GT(data["vertices_read"], 0);
    if (r["shading"].contains("vectors")) {
      EXPECT_EQ(r["shading"]["vectors"]["rays"], r["shading"]["shaded"]);
    }
    EXPECT_FALSE(r["shading"].contains("products")) << "they are instructions";
    EXPECT_GE(1, of("occupancy"));
    EXPECT_GE(1, of("lane_fill"));
    EXPECT_EQ(r["digest"], report(machine("cycles_per_shade: 7"), {"scene={builtin: cornell}"})["digest"]);
  }
}

// More registers hold more vectors, which hide each other's waits.
TEST_F(ShaderPrograms, RegistersLimitTheRaysThatAreHeld) {
  const auto run = [this](int vectors) {
    return report(machine(fmt::format("registers: {}, program: own", vectors * 11),
                          "'load a, 2', 'sqrt b, a', 'sqrt a, b', 'sqrt b, a', 'sqrt a, b', 'sqrt b, a'"),
                  {"shading.workers=1"});
  };
  const Json one = run(1), four = run(4);
  EXPECT_EQ(one["shading"]["programs"]["registers"], 11);
  EXPECT_EQ(one["shading"]["programs"]["vectors_held"], 1);
  EXPECT_EQ(four["shading"]["programs"]["vectors_held"], 4);
  EXPECT_DOUBLE_EQ(one["shading"]["programs"]["occupancy"].get<double>(), 1);
  EXPECT_LT(2 * cycles(four), cycles(one));
  // One vector at a time: 4 + 4 x 16 + 1 cycles a ray, made or shaded.
  const double rays = one["rays"]["completed"].get<double>() + one["rays"]["by_kind"]["camera"].get<double>();
  EXPECT_NEAR(one["shading"]["utilisation"].get<double>() * static_cast<double>(cycles(one)), rays * 69,
              1e-6 * rays * 69);
  // Waits leave the worker to other vectors, if it holds any: its bound is six instructions a ray, however many it
  // holds.
  for (const Json& r : {one, four})
    EXPECT_NEAR(bound(r), 1000 * one["rays"]["completed"].get<double>() / (6 * rays), 1e-6 * bound(r));
}

// Each kind of work has its own program.
TEST_F(ShaderPrograms, AreChosenByKind) {
  const Json r = report(machine("program: {default: own, miss: built_in, shadow: built_in}", loads(3)));
  const Json& p = r["shading"]["programs"];
  EXPECT_GT(p["product"], 0) << "of misses and shadow rays";
  const Json all = report(machine("program: own", loads(3)));
  EXPECT_EQ(all["shading"]["programs"]["product"], 0);
  EXPECT_EQ(all["digest"], r["digest"]);
}

}  // namespace
}  // namespace carousel::shader_programs_test
