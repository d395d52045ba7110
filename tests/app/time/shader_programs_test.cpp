// Whole machines whose shader workers run programs.
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "core/system/error.h"
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

// Reads go through the data cache and the pages of their worker, and nothing else changes.
TEST_F(ShaderPrograms, ReadThroughADataCacheAndPages) {
  const std::vector<std::string> with{"shading.workers=1", "energy.profile=n45"};
  const Json bare = report(machine("program: built_in"), with);
  const auto bytes = [](const Json& r) {
    const Json& data = r["memory"]["ray_data"];
    return data["materials_read"].get<std::uint64_t>() + data["vertices_read"].get<std::uint64_t>() +
           data["texels_read"].get<std::uint64_t>();
  };
  EXPECT_FALSE(bare["shading"]["programs"].contains("data"));
  EXPECT_EQ(bytes(bare), 64 * bare["shading"]["programs"]["data_reads"].get<std::uint64_t>());
  std::uint64_t misses = ~std::uint64_t{0};
  for (const int size : {256, 1024, 1 << 20}) {
    SCOPED_TRACE(size);
    const Json r = report(
        machine(fmt::format("program: built_in, data_cache: {{bytes: {}}}, translation: {{page_bytes: 4096}}", size)),
        with);
    const Json& d = r["shading"]["programs"]["data"];
    const auto of = [&](const char* key) { return d[key].get<std::uint64_t>(); };
    EXPECT_EQ(r["digest"], bare["digest"]);
    EXPECT_EQ(d["lines"], r["shading"]["programs"]["data_reads"]);
    EXPECT_EQ(d["pages"], d["lines"]);
    EXPECT_EQ(bytes(r), 64 * of("misses"));
    EXPECT_LE(of("hits") + of("misses"), of("lines"));
    EXPECT_EQ(of("walk_reads"), 4 * of("walks"));
    EXPECT_EQ(r["memory"]["ray_data"]["pages_read"], 8 * of("walk_reads"));
    EXPECT_LT(of("misses"), misses) << "more lines have room";
    misses = of("misses");
    // Registers, the store of programs, the cache, and 32 pages of 16 bytes, at the area of memory.
    const double kib = (size + 32 * 16) / 1024.0;
    const double mm2_of_kib =
        r["area"]["parts"]["l2"]["mm2"].get<double>() / r["area"]["parts"]["l2"]["size"].get<double>();
    EXPECT_NEAR(
        r["area"]["parts"]["shaders"]["mm2"].get<double>() - bare["area"]["parts"]["shaders"]["mm2"].get<double>(),
        kib * mm2_of_kib, 1e-6);
    EXPECT_GT(r["energy"]["parts"]["shades"]["joules"], bare["energy"]["parts"]["shades"]["joules"]);
  }
  const std::string one_vector = "registers: 64, program: built_in";
  const Json large = report(machine(one_vector + ", data_cache: {bytes: 1048576, latency_cycles: 4}"), with);
  EXPECT_EQ(large["shading"]["programs"]["data"]["walks"], 0);
  EXPECT_LT(cycles(large), cycles(report(machine(one_vector), with)));
}

TEST_F(ShaderPrograms, DataCachesAndPagesAreWhole) {
  const auto refused = [&](const std::string& set) -> std::string {
    try {
      report(machine("program: built_in, data_cache: {bytes: 1024}"), {set});
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "";
  };
  using testing::HasSubstr;
  EXPECT_THAT(refused("shading.data_cache.bytes=1000"),
              HasSubstr("expected a multiple of the 256 bytes of 4 lines, found 1000"));
  EXPECT_THAT(refused("shading.data_cache.line_bytes=96"),
              HasSubstr("expected a multiple of memory.line_bytes, which are 64, found 96"));
  EXPECT_THAT(refused("shading.translation.page_bytes=6000"),
              HasSubstr("expected 0, or a power of two from 4096, found 6000"));
  const auto lines_of_192 = [&](const std::string& cache) {
    return refused("shading={program: built_in, workers: 1, translation: {page_bytes: 4096}, data_cache: " + cache +
                   "}");
  };
  EXPECT_THAT(lines_of_192("{line_bytes: 192, bytes: 1536}"),
              HasSubstr("expected whole lines of 192 bytes, found 4096"));
  EXPECT_EQ(lines_of_192("{line_bytes: 192}"), "") << "there is no cache";
}

// Shading without programs reads the same surfaces, if they are in memory: those of rays that hit one.
TEST_F(ShaderPrograms, SurfacesAreReadWithoutThemToo) {
  const Json programs = report(machine("program: own", "'read a, material', 'read b, vertices'"));
  const Json free = report(machine("cycles_per_shade: 20")),
             memory = report(machine("cycles_per_shade: 20"), {"memory.surfaces=memory"});
  EXPECT_FALSE(free["memory"].contains("ray_data"));
  for (const char* key : {"materials_read", "vertices_read"})
    EXPECT_EQ(memory["memory"]["ray_data"][key], programs["memory"]["ray_data"][key]) << key;
  std::uint64_t hits = 0;
  for (const Json& bounce : memory["rays"]["by_bounce"]) hits += bounce["hit"].get<std::uint64_t>();
  EXPECT_EQ(memory["memory"]["ray_data"]["materials_read"], 128 * hits);
  EXPECT_EQ(memory["digest"], free["digest"]);
  EXPECT_GT(cycles(memory), cycles(free));
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
