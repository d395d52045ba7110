#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/program/shade_programs.h"
#include "core/statistics/shading_counts.h"
#include "core/types/shade_facts.h"
#include "ringbus/cycle/shading/programs/instruction_cache.h"
#include "ringbus/cycle/shading/programs/program_memory.h"
#include "ringbus/cycle/shading/programs/shade_lanes.h"
#include "ringbus/time/clock.h"

namespace carousel::ringbus::cycle {

/// A shader worker that runs programs: it holds several vectors of rays, and issues an instruction of one of them a
/// cycle. A vector issues in order, when the line of the instruction cache and the operands are there and the earlier
/// value of the register that it writes has come; after a branch or a trace it waits for the latency of these. Of the
/// vectors that can issue the one goes first that could first. A vector ends when its last instruction has been issued,
/// as run_program() says, and all that it has read has come.
class ShadeCore {
 public:
  /// A ray of a vector, and the kind of its work (kShaderKindNames).
  struct Ray {
    std::uint32_t kind = 0;
    ShadeFacts facts{};
  };

  /// Holds up to `vectors`. Keeps references to the programs and the memory.
  ShadeCore(const ShadePrograms& programs, const InstructionCacheConfig& cache, std::uint32_t worker,
            std::size_t vectors, std::size_t lanes)
      : programs_(programs), cache_(cache), worker_(worker), lanes_(lanes), vectors_(vectors) {}

  /// A vector begins in place `at`, which is free. Rays whose kinds have different programs take turns, in the order of
  /// the first rays of each; rays of one program go in step, as many as there are lanes.
  void begin(std::size_t at, std::vector<Ray>&& rays, Cycle now);
  /// The worker does something else, after what it began before; returns its end.
  Cycle occupy(Cycle cycles, Cycle now);
  /// A read has come.
  void answer(const ProgramRead& read, Cycle now);
  /// Issues what can be issued now; appends the places of vectors that have ended to `ended`, and forgets them.
  void step(Cycle now, ProgramMemory* memory, std::vector<std::size_t>& ended);
  /// The cycle of the next step, kNever if it waits for data or holds nothing.
  Cycle next() const { return next_; }

  const ShadeProgramCounts& counts() const { return counts_; }
  /// Of completed rays.
  const ShadeVectorCounts& vectors() const { return vector_counts_; }
  /// Cycles in which the worker issued an instruction, or did something else.
  Cycle issuing() const { return counts_.issued + occupied_; }
  std::uint64_t instruction_misses() const { return cache_.misses(); }
  std::uint64_t instruction_bytes() const { return cache_.bytes(); }

 private:
  enum class Stage : std::uint8_t { kFree, kDecide, kFetch, kOperands, kIssue };
  using Stall = std::uint64_t ShadeProgramCounts::*;

  struct Vector {
    Stage stage = Stage::kFree;
    Cycle at = kNever;  // from when the stage goes on
    Cycle counted = 0;  // up to here its time has been accounted for
    Cycle began = 0;
    Stall after = nullptr;  // of the wait in kDecide
    std::vector<Ray> rays;
    std::vector<std::vector<std::uint32_t>> runs;  // rays that go in step, by turn
    std::size_t run = 0;
    ShadeLanes lanes;
    std::vector<std::uint32_t> lookups;  // by lane: textures read
    std::array<Cycle, kMostRegisters> ready{};
    std::array<std::uint32_t, kMostRegisters> missing{};  // reads under way
    std::array<Cycle, kMostRegisters> filter{};           // after the last of them
    std::array<bool, kMostRegisters> read{};              // it holds what was read
    std::uint32_t reads = 0;
  };

  std::size_t program_of(const Vector& v) const { return programs_.of_kind[v.rays[v.runs[v.run].front()].kind]; }
  void begin_run(Vector& v, Cycle now);
  /// Goes on until the vector can issue, waits, or has ended, which it returns.
  bool advance(Vector& v, Cycle now);
  bool operands_are_there(Vector& v, Cycle now);
  void issue(std::size_t at, Cycle now, ProgramMemory* memory);
  std::uint32_t ask(std::size_t at, const Instruction& i, Cycle now, ProgramMemory* memory);
  void wait(Vector& v, Stall why, Cycle until);
  void find_next();

  const ShadePrograms& programs_;
  InstructionCache cache_;
  std::uint32_t worker_;
  std::size_t lanes_;
  std::vector<Vector> vectors_;
  Cycle issue_free_ = 0;  // the first cycle in which nothing has been issued
  Cycle occupied_ = 0;    // by what is no vector
  Cycle next_ = kNever;
  ShadeProgramCounts counts_;
  ShadeVectorCounts vector_counts_;
};

}  // namespace carousel::ringbus::cycle
