#pragma once

#include <optional>

#include "core/config/fields/scene.h"
#include "core/program/compile.h"

namespace carousel {

/// The compiled program of a primitive; absent if something is wrong with it, which `fault` then says.
inline std::optional<RayProgram> program_of(const PrimitiveConfig& primitive, const ProgramsConfig& programs,
                                            ProgramFault& fault) {
  const auto cycles = [](std::int64_t value) { return static_cast<std::uint8_t>(value); };
  std::optional<RayProgram> out = compile_program(primitive.program, primitive.parameters.values,
                                                  {cycles(programs.simple_cycles), cycles(programs.product_cycles),
                                                   cycles(programs.divide_cycles), cycles(programs.branch_cycles)},
                                                  fault);
  if (out) out->offset = static_cast<float>(primitive.offset);
  return out;
}

}  // namespace carousel
