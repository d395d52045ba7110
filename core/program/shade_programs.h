#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/program/program.h"
#include "core/types/shader_kind.h"

namespace carousel {

/// The programs that shader workers run. Their instructions stand one program after another in one store, each program
/// at the beginning of a line.
struct ShadePrograms {
  std::vector<RayProgram> programs;
  std::vector<std::uint64_t> address;  ///< by program: of its first instruction (bytes)
  std::array<std::uint32_t, kShaderKinds> of_kind{};
  bool any_hit = false;           ///< of_kind has a program for any-hit calls, which otherwise take a constant time
  std::size_t registers = 1;      ///< of the program that has most
  std::uint64_t store_bytes = 0;  ///< of all instructions
};

}  // namespace carousel
