#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/types/shade_facts.h"

namespace carousel {

/// What an instruction does (docs/reference/instructions.md). `d`, `a`, `b`, `c` are registers.
enum class Op : std::uint8_t {
  kLoad,       ///< d = value
  kMove,       ///< d = a
  kAdd,        ///< d = a + b
  kSub,        ///< d = a - b
  kMul,        ///< d = a * b
  kFma,        ///< d = a * b + c, rounded once
  kDiv,        ///< d = a / b
  kSqrt,       ///< d = sqrt(a)
  kMin,        ///< d = a < b ? a : b
  kMax,        ///< d = a > b ? a : b
  kAbs,        ///< d = |a|
  kNeg,        ///< d = -a
  kFloor,      ///< d = the largest integer that is not above a
  kLess,       ///< d = a < b ? 1 : 0
  kLessEqual,  ///< d = a <= b ? 1 : 0
  kEqual,      ///< d = a == b ? 1 : 0
  kSelect,     ///< d = a != 0 ? b : c
  kHit,        ///< reports a hit at d with the normal (a, b, c)
  kLoop,       ///< counter c = value
  kEnd,        ///< counter c is lowered; if it is above 0, goes to target
  kIfZero,     ///< if a == 0, goes to target
  kIfNonzero,  ///< if a != 0, goes to target
  kJump,       ///< goes to target
  kRead,       ///< d = 0 when the data `target` of ShadeData has come; shaders alone, as the next two
  kTexture,    ///< d = 0 when the texels of the surface's next lookup, at a, have come and are filtered
  kTrace,      ///< writes a new ray, in the direction a
};

/// Instructions of one class take the same time and energy.
enum class OpClass : std::uint8_t { kSimple, kProduct, kDivide, kBranch, kRead, kTexture, kTrace };
inline constexpr std::size_t kOpClasses = 7;

/// Cycles from the issue of an instruction of each class until its result may be read: of a read or a texture from when
/// its data has come. After a branch or a trace the next instruction waits for so long.
using OpLatencies = std::array<std::uint8_t, kOpClasses>;

struct Instruction {
  Op op;
  OpClass of;
  std::uint8_t d, a, b, c;  ///< operands that an instruction does not have repeat one that it has
  std::uint16_t target;     ///< an index of the code, or its size, which ends the program
  float value;
};
static_assert(sizeof(Instruction) == 12);

inline constexpr std::size_t kMostRegisters = 64;
inline constexpr std::size_t kMostInstructions = 4096;  ///< of a program
inline constexpr std::uint64_t kMostSteps = 1 << 16;    ///< instructions of a test at most
inline constexpr std::size_t kMostLoops = 4;            ///< within one another
inline constexpr std::size_t kMostProgramHits = 8;      ///< of a test; those behind them are not taken
inline constexpr std::uint32_t kInstructionBytes = 8;   ///< of an instruction in the unit's store

/// The registers that hold the ray when a program begins. They are only read.
inline constexpr std::array<std::string_view, 8> kProgramInputs{"ox", "oy", "oz", "dx", "dy", "dz", "tmin", "tmax"};

/// The purpose of a program: the registers that it finds filled, and the instructions that it may have.
struct ProgramUse {
  std::span<const std::string_view> inputs;
  bool shades;         ///< of a shader worker; otherwise it finds the hits of a primitive
  bool traces = true;  ///< may send rays, if it shades
};
inline constexpr ProgramUse kPrimitiveUse{kProgramInputs, false}, kShaderUse{kShadeFactNames, true},
    kAnyHitUse{kShadeFactNames, true, false};

/// A compiled program: a flat list of instructions, which ends behind its last one. Every loop has a bound, every
/// register is set before it is read, and no test takes more than kMostSteps.
struct RayProgram {
  std::vector<Instruction> code;
  OpLatencies latencies{4, 4, 16, 2};
  std::size_t registers = kMostRegisters;  ///< those that it names, those that it finds filled included
  float offset = 0;                        ///< in model units: the error of a hit along its normal
};

}  // namespace carousel
