#pragma once

#include <optional>

#include "core/config/fields/scene.h"
#include "core/config/shader_programs.h"
#include "core/program/compile.h"

namespace carousel {

/// The compiled program of a primitive; absent if something is wrong with it, which `fault` then says.
inline std::optional<RayProgram> program_of(const PrimitiveConfig& primitive, const ProgramsConfig& programs,
                                            ProgramFault& fault) {
  std::optional<RayProgram> out =
      compile_program(primitive.program, primitive.parameters.values, latencies_of(programs), fault);
  if (out) out->offset = static_cast<float>(primitive.offset);
  return out;
}

}  // namespace carousel
