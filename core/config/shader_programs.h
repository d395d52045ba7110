#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "core/config/fields/scene.h"
#include "core/config/fields/shading.h"
#include "core/config/fields/testers.h"
#include "core/program/compile.h"
#include "core/program/shade_programs.h"

namespace carousel {

/// The latencies of the classes of instructions.
OpLatencies latencies_of(const ProgramsConfig& programs);

/// The compiled program of shader workers that has a name; absent if something is wrong with it, which `fault` then
/// says. `built_in` is that of the kind.
std::optional<RayProgram> shader_of(const std::string& name, std::size_t kind, const ProgramsConfig& programs,
                                    ProgramFault& fault);

/// A page of a TLB: its number, and where it lies.
inline constexpr std::int64_t kTlbEntryBytes = 16;

/// Any-hit calls come to shader workers, which run a program for them.
bool runs_any_hit_programs(const ShadingConfig& shading, const TestersConfig& testers);

/// The programs of a configuration whose shader workers run any, and which has been checked.
ShadePrograms shade_programs(const ShadingConfig& shading, const ProgramsConfig& programs,
                             const TestersConfig& testers);

/// The vectors of rays that a shader worker holds at once.
std::size_t vectors_held(const ShadingConfig& shading, const ShadePrograms& programs);

}  // namespace carousel
