#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/program/program.h"
#include "core/types/ray.h"

namespace carousel {

/// A hit as a program reports it: where on the ray, and a normal of any length.
struct ReportedHit {
  float t;
  Vec3 normal;
};

/// A run of a program came to this.
struct ProgramRun {
  std::array<ReportedHit, kMostProgramHits> hit;
  std::size_t hits = 0;
  std::uint64_t cycles = 0;                              ///< in a unit; see run_program()
  std::array<std::uint64_t, kOpClasses> instructions{};  ///< by class
};

/// Runs a program of compile_program() for a ray in the primitive's space. Each instruction is rounded once to float,
/// to nearest, and nothing is contracted, so that the hits are the same on every host.
///
/// The time is that of a unit that issues an instruction a cycle, in order: when its operands are there and the earlier
/// value of the register that it writes has come, as the latencies of the classes say. After a branch the next one is
/// issued when the branch's latency is over. The run is over when its last instruction has been issued and, if that is
/// a branch, has been decided; a value that nothing reads is not waited for.
ProgramRun run_program(const RayProgram& program, const Ray& ray);

}  // namespace carousel
