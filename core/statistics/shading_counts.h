#pragma once

#include "core/statistics/counters.h"

namespace carousel {

/// The vectors in which shader workers of several lanes shaded completed rays.
struct ShadeVectorCounts {
  std::uint64_t vectors = 0, rays = 0;
  std::uint64_t runs = 0;  ///< runs of a shader for its rays of a vector

  static constexpr auto counters() {
    using C = ShadeVectorCounts;
    return std::array{
        Counter{"vectors", &C::vectors, "vectors", "vectors of completed rays that the workers shaded"},
        Counter{"rays", &C::rays, "rays", "rays of these"},
        Counter{"runs", &C::runs, "passes", "passes of a shader for its rays of a vector", Shown::kNever},
    };
  }
  friend bool operator==(const ShadeVectorCounts&, const ShadeVectorCounts&) = default;
};

/// What the programs of shader workers did. A cycle in which a worker holds a vector is one in which the vector issues
/// an instruction, or one of the stalls, so that these add up to vector_cycles.
struct ShadeProgramCounts {
  std::uint64_t vector_cycles = 0, issued = 0;
  std::uint64_t operand_stalls = 0, branch_stalls = 0, trace_stalls = 0, memory_stalls = 0, instruction_stalls = 0,
                issue_stalls = 0;
  std::uint64_t simple = 0, product = 0, divide = 0, branch = 0, read = 0, texture = 0, trace = 0;
  std::uint64_t data_reads = 0, instruction_misses = 0, instruction_bytes = 0, any_hit_calls = 0;

  static constexpr auto counters() {
    using C = ShadeProgramCounts;
    return std::array{
        Counter{"vector_cycles", &C::vector_cycles, "cycles",
                "sum over vectors of the time that a worker held them: the instructions issued and the stalls below"},
        Counter{"issued", &C::issued, "instructions", "instructions issued, one a cycle and worker"},
        Counter{"operand_stalls", &C::operand_stalls, "cycles", "vectors waited for results of arithmetic"},
        Counter{"branch_stalls", &C::branch_stalls, "cycles", "vectors waited for a branch to be decided"},
        Counter{"trace_stalls", &C::trace_stalls, "cycles", "vectors waited while new rays were written"},
        Counter{"memory_stalls", &C::memory_stalls, "cycles",
                "vectors waited for materials, vertices or texels, or for their filtering"},
        Counter{"instruction_stalls", &C::instruction_stalls, "cycles",
                "vectors waited for a line of the instruction cache"},
        Counter{"issue_stalls", &C::issue_stalls, "cycles",
                "vectors could have issued, and another vector did, or any-hit calls held the worker"},
        Counter{"simple", &C::simple, "instructions",
                "sums, comparisons, moves and loads, counted once for each ray, as those below"},
        Counter{"product", &C::product, "instructions", "mul and fma"},
        Counter{"divide", &C::divide, "instructions", "div and sqrt"},
        Counter{"branch", &C::branch, "instructions", "if, else, loop, end, break and stop"},
        Counter{"read", &C::read, "instructions", "read"},
        Counter{"texture", &C::texture, "instructions", "texture"},
        Counter{"trace", &C::trace, "instructions", "trace"},
        Counter{"data_reads", &C::data_reads, "lines",
                "lines of materials, vertices and texels that were read, each once for the rays of a vector at an "
                "instruction"},
        Counter{"instruction_misses", &C::instruction_misses, "misses", "lines that instruction caches did not have"},
        Counter{"instruction_bytes", &C::instruction_bytes, "bytes", "bytes of these lines"},
        Counter{"any_hit_calls", &C::any_hit_calls, "calls", "any-hit calls that ran a program"},
    };
  }
  constexpr std::uint64_t stalls() const {
    return operand_stalls + branch_stalls + trace_stalls + memory_stalls + instruction_stalls + issue_stalls;
  }
  /// Instructions, once for each ray.
  constexpr std::uint64_t lane_instructions() const {
    return simple + product + divide + branch + read + texture + trace;
  }
  friend bool operator==(const ShadeProgramCounts&, const ShadeProgramCounts&) = default;
};

/// What data caches and TLBs of shader workers did.
struct ShadeDataCounts {
  std::uint64_t lines = 0, hits = 0, misses = 0, pages = 0, page_misses = 0, walks = 0, walk_reads = 0;

  static constexpr auto counters() {
    using C = ShadeDataCounts;
    return std::array{
        Counter{"lines", &C::lines, "lines", "lines that were looked up in data caches"},
        Counter{"hits", &C::hits, "lines", "lines of these that were there"},
        Counter{"misses", &C::misses, "lines",
                "lines that were then read from memory; the rest were under way already"},
        Counter{"pages", &C::pages, "lines", "lines whose pages were looked up in TLBs"},
        Counter{"page_misses", &C::page_misses, "lines", "lines of these whose pages were not there"},
        Counter{"walks", &C::walks, "pages", "pages for which walkers began to read the page table"},
        Counter{"walk_reads", &C::walk_reads, "entries", "entries that they read, one a level"},
    };
  }
  friend bool operator==(const ShadeDataCounts&, const ShadeDataCounts&) = default;
};

/// The work of shader workers.
struct ShadingCounts {
  std::uint64_t busy = 0;      ///< worker-cycles, without resources that help
  std::uint64_t products = 0;  ///< counts of ShadeWork, as `lookups`
  std::uint64_t lookups = 0;
  ShadeVectorCounts vectors;
  ShadeProgramCounts programs;
  ShadeDataCounts data;
  ShadingCounts& operator+=(const ShadingCounts& o) {
    busy += o.busy;
    products += o.products;
    lookups += o.lookups;
    vectors += o.vectors;
    programs += o.programs;
    data += o.data;
    return *this;
  }
  friend bool operator==(const ShadingCounts&, const ShadingCounts&) = default;
};

}  // namespace carousel
