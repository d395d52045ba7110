#include "core/program/run.h"

#include <algorithm>

#include "core/program/arithmetic.h"

namespace carousel {

ProgramRun run_program(const RayProgram& program, const Ray& ray) {
  ProgramRun out;
  std::array<float, kMostRegisters> r{};              // also read, and not used, by instructions without operands
  std::array<std::uint64_t, kMostRegisters> ready{};  // cycles in which the registers may be read
  std::array<std::uint32_t, kMostLoops> counter{};
  r[0] = ray.origin.x, r[1] = ray.origin.y, r[2] = ray.origin.z;
  r[3] = ray.direction.x, r[4] = ray.direction.y, r[5] = ray.direction.z;
  r[6] = ray.tmin, r[7] = ray.tmax;
  std::uint64_t now = 0;
  for (std::size_t at = 0; at < program.code.size();) {
    const Instruction& i = program.code[at++];
    const std::uint64_t issued = std::max({now, ready[i.a], ready[i.b], ready[i.c], ready[i.d]});
    const std::uint64_t latency = program.latencies[static_cast<std::size_t>(i.of)];
    ++out.instructions[static_cast<std::size_t>(i.of)];
    now = issued + (i.of == OpClass::kBranch ? latency : 1);
    const float a = r[i.a], b = r[i.b], c = r[i.c];
    switch (i.op) {
      case Op::kHit:
        if (out.hits < kMostProgramHits) out.hit[out.hits++] = {r[i.d], {a, b, c}};
        continue;
      case Op::kLoop:
        counter[i.c] = static_cast<std::uint32_t>(i.value);
        continue;
      case Op::kEnd:
        if (--counter[i.c] > 0) at = i.target;
        continue;
      case Op::kIfZero:
        if (a == 0) at = i.target;
        continue;
      case Op::kIfNonzero:
        if (a != 0) at = i.target;
        continue;
      case Op::kJump:
        at = i.target;
        continue;
      default:
        break;
    }
    r[i.d] = value_of(i, a, b, c);
    ready[i.d] = issued + latency;
  }
  out.cycles = now;
  return out;
}

}  // namespace carousel
