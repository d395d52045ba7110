#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/config/fields/engine_kind.h"
#include "core/config/fields/field.h"
#include "core/config/fields/queue_kind.h"
#include "core/types/shader_kind.h"

namespace carousel {

/// The flags that shaders give their rays of one kind (core/types/ray.h).
struct RayFlags {
  enum class Cull { kNone, kBack, kFront } cull = Cull::kNone;
  bool force_opaque = false;
};

/// The programs of shader workers: of each kind of work (kShaderKindNames), and where that is empty of all others.
struct ShaderProgramsConfig {
  static constexpr std::string_view kConstant = "constant", kBuiltIn = "built_in";  ///< names that are no programs

  std::string standard{kConstant};
  std::array<std::string, kShaderKinds> of_kind{};

  bool any() const { return standard != kConstant; }
  /// Any-hit calls that come to shader workers run a program.
  bool any_hit() const { return any() && of(kAnyHitKind) != kConstant; }
  const std::string& of(std::size_t kind) const { return of_kind[kind].empty() ? standard : of_kind[kind]; }
};

/// The cache through which a shader worker fetches the instructions of programs.
struct InstructionCacheConfig {
  std::int64_t bytes = 0, line_bytes = 64, miss_cycles = 40;
};

/// The cache through which programs of a shader worker read materials, vertices and texels.
struct DataCacheConfig {
  std::int64_t bytes = 0, ways = 4, latency_cycles = 20;
  std::optional<std::int64_t> line_bytes;  ///< absent: that of the shared caches
};

/// How a shader worker finds the physical addresses of these data.
struct TranslationConfig {
  std::int64_t page_bytes = 0, entries = 32;
};

struct ShadingConfig {
  std::optional<std::int64_t> workers;  ///< absent: `auto`; see shader_workers() in core/config/config.h
  struct Effects {
    enum class Choice { kAuto, kAll, kList } choice = Choice::kAuto;
    std::vector<std::string> names;  ///< for kList
  } effects;
  bool idle_resources_shade = false;
  std::int64_t cycles_per_shade = 20;
  ShaderProgramsConfig program;
  std::int64_t registers = 4096;
  InstructionCacheConfig instruction_cache;
  DataCacheConfig data_cache;
  TranslationConfig translation;
  enum class Distribute { kFifoFill, kLoad, kRoundRobin, kRandom } distribute = Distribute::kFifoFill;
  std::int64_t cycles_per_any_hit = 10, cycles_per_lookup = 5, products_per_cycle = 8;
  std::int64_t lanes = 1, sort_rays_per_cycle = 4;
  enum class Sort { kNone, kShader } sort = Sort::kNone;
  RayFlags camera_rays{}, bounce_rays{}, shadow_rays{};
  RayQueueConfig queue{QueueKind::kMpmcRing, 16};
};

template <>
inline constexpr auto kEnumNames<RayFlags::Cull> = [] {
  using enum RayFlags::Cull;
  return names<RayFlags::Cull>({{kNone, "none"}, {kBack, "back"}, {kFront, "front"}});
}();

template <>
inline constexpr auto kEnumNames<ShadingConfig::Distribute> = [] {
  using enum ShadingConfig::Distribute;
  return names<ShadingConfig::Distribute>(
      {{kFifoFill, "fifo_fill"}, {kLoad, "load"}, {kRoundRobin, "round_robin"}, {kRandom, "random"}});
}();

template <>
inline constexpr auto kEnumNames<ShadingConfig::Sort> = [] {
  using enum ShadingConfig::Sort;
  return names<ShadingConfig::Sort>({{kNone, "none"}, {kShader, "shader"}});
}();

namespace config {

template <class V>
void describe(V& v, RayFlags& c) {
  v.choice("cull", c.cull, "These rays pass through triangles that show them their back, or their front.");
  v.field("force_opaque", c.force_opaque, "", "These rays take every triangle for opaque.");
}

template <class V>
void describe(V& v, ShaderProgramsConfig& c) {
  v.field("default", c.standard, "",
          "The program of all work that no key beside this one names. A program is one of programs.shaders, or with "
          "built_in that of this program's own shading code; with constant there is none.");
  for (std::size_t kind = 0; kind < kShaderKinds; ++kind)
    v.field(
        kShaderKindNames[kind], c.of_kind[kind], "",
        "The program for this kind: rays that left the scene, shadow rays, hits by the class of their surface "
        "(shading.classes of the report), the making of camera rays, and any-hit calls, which alone may be constant.");
}

template <class V>
void describe(V& v, InstructionCacheConfig& c) {
  v.field("bytes", c.bytes, IntRange{0, 1 << 24}, "bytes",
          "The size of the cache of a shader worker, which is direct-mapped. With 0 all instructions are at hand.");
  v.field("line_bytes", c.line_bytes, IntRange{8, 4096}, "bytes", "The size of a line, 8 bytes an instruction.");
  v.field("miss_cycles", c.miss_cycles, kCycles, "cycles", "The time until a line is there that was not.");
}

template <class V>
void describe(V& v, DataCacheConfig& c) {
  v.field("bytes", c.bytes, IntRange{0, 1 << 24}, "bytes",
          "The size of the cache of a shader worker, which looks up a line a cycle. With 0 the lines come from the "
          "shared caches each time.")
      .relax("shading_data_cache", Better::kTwice, Relaxed{}, c.bytes > 0);
  v.field_or_auto("line_bytes", c.line_bytes, IntRange{16, 4096}, "bytes",
                  "The size of a line. With auto it is memory.line_bytes.");
  v.field("ways", c.ways, IntRange{1, 64}, "ways", "The associativity of the cache.");
  v.field("latency_cycles", c.latency_cycles, kCycles, "cycles",
          "The time of a hit, and that after which a line that is not there is asked for.");
}

template <class V>
void describe(V& v, TranslationConfig& c) {
  v.field("page_bytes", c.page_bytes, IntRange{0, 1 << 30}, "bytes",
          "The size of a page, a power of two from 4096. With 0 addresses are physical.");
  v.field("entries", c.entries, IntRange{1, 4096}, "entries",
          "The pages that the TLB of a shader worker holds. For another one its walker reads the levels of the page "
          "table through the shared caches, one after another.")
      .relax("shading_tlb", Better::kTwice, Relaxed{}, c.page_bytes > 0);
}

template <class V>
void describe(V& v, ShadingConfig& c) {
  v.field_or_auto("workers", c.workers, IntRange{1, 256}, "workers",
                  "The number of shader workers. With auto the cycle engine has two for each resource, and the native "
                  "engine, where a worker is work for the host, two in all.")
      .relax("shading", Better::kTwice);
  v.effects("effects", c.effects,
            "The effects of light: those that the scene calls for (auto), all of them (nothing is specialised), or of "
            "those that the scene calls for only the named ones.");
  v.field("idle_resources_shade", c.idle_resources_shade, "", "Idle resources help the shader workers.")
      .only(EngineKind::kCycle, "shading by idle resources", true);
  v.field("cycles_per_shade", c.cycles_per_shade, IntRange{0, 1'000'000}, "cycles",
          "The time to shade a ray that hit a plain surface or nothing.");
  v.section_or_text("program", c.program,
                    "The programs that take the time of shading, in place of cycles_per_shade, cycles_per_lookup and "
                    "products_per_cycle. A name stands for {default: NAME}.");
  v.field("registers", c.registers, IntRange{1, 1 << 20}, "registers",
          "With a program, the registers of a shader worker, of 32 bits. They hold as many vectors of `lanes` rays as "
          "have room with the registers of the largest program, 64 at most.")
      .relax("shading_registers", Better::kTwice, Relaxed{}, c.program.any());
  v.section("instruction_cache", c.instruction_cache,
            "What a shader worker fetches the instructions of programs through.");
  v.section("data_cache", c.data_cache,
            "What programs of a shader worker read materials, vertices and texels through.");
  v.section("translation", c.translation, "How a shader worker finds where these data are.");
  v.field("cycles_per_lookup", c.cycles_per_lookup, IntRange{0, 1'000'000}, "cycles",
          "The additional time for each filtered texture lookup at a surface.");
  v.field("products_per_cycle", c.products_per_cycle, IntRange{0, 4096}, "products/cycle",
          "The products of a surface's effects that a shader worker computes in a cycle, beyond those of a plain "
          "surface. With 0 they take no time.");
  v.field("cycles_per_any_hit", c.cycles_per_any_hit, IntRange{0, 1'000'000}, "cycles",
          "The time in which a shader worker decides if a non-opaque primitive is hit, with testers.any_hit: shader "
          "and no program for it.");
  v.field(
       "lanes", c.lanes, IntRange{1, 64}, "rays",
       "The rays that a shader worker shades side by side as a vector. A vector takes its shaders one after another.")
      .relax("shading_lanes", Better::kTwice, Relaxed{}, c.lanes > 1)
      .only(EngineKind::kCycle, "vectors of a shader worker");
  v.choice("sort", c.sort,
           "A vector has the completed rays that have waited longest, or completed rays are sorted by shader and a "
           "vector has rays of one.")
      .relax("shading_order", ShadingConfig::Sort::kShader, Relaxed{.times = 0}, c.lanes > 1)
      .only(EngineKind::kCycle, "vectors of a shader worker", ShadingConfig::Sort::kShader);
  v.field("sort_rays_per_cycle", c.sort_rays_per_cycle, IntRange{1, 1024}, "rays/cycle",
          "With sort: shader, the completed rays that are sorted in a cycle.")
      .relax("shading_sorter", Better::kTwice);
  v.section("camera_rays", c.camera_rays, "The flags of camera rays.");
  v.section("bounce_rays", c.bounce_rays, "The flags of bounce rays.");
  v.section("shadow_rays", c.shadow_rays, "The flags of shadow rays.");
  v.choice("distribute", c.distribute, "The rule that chooses the worker of a completed ray.")
      .only(EngineKind::kCycle, "choice of shader workers");
  v.choice("queue", c.queue.kind,
           "The queue that brings completed rays from the resources to the shader workers in the native engine.")
      .only(EngineKind::kNative, "real queues");
  v.field("queue_depth", c.queue.depth, IntRange{1, 65536}, "batches",
          "The number of batches of completed rays, of some hundred each, that this queue holds.")
      .only(EngineKind::kNative, "real queues");
}

}  // namespace config
}  // namespace carousel
