#include "core/config/shader_programs.h"

#include <algorithm>
#include <map>
#include <utility>

#include "core/program/built_in_shaders.h"

namespace carousel {

OpLatencies latencies_of(const ProgramsConfig& programs) {
  const auto cycles = [](std::int64_t value) { return static_cast<std::uint8_t>(value); };
  return {cycles(programs.simple_cycles),
          cycles(programs.product_cycles),
          cycles(programs.divide_cycles),
          cycles(programs.branch_cycles),
          0,
          cycles(programs.texture_cycles),
          cycles(programs.trace_cycles)};
}

std::optional<RayProgram> shader_of(const std::string& name, std::size_t kind, const ProgramsConfig& programs,
                                    ProgramFault& fault) {
  const OpLatencies latencies = latencies_of(programs);
  const ProgramUse& use = kind == kAnyHitKind ? kAnyHitUse : kShaderUse;
  if (name == ShaderProgramsConfig::kBuiltIn) return compile_program(built_in_shader(kind), {}, latencies, fault, use);
  const ShaderConfig& own = programs.shaders.named.at(name);
  return compile_program(own.program, own.parameters.values, latencies, fault, use);
}

bool runs_any_hit_programs(const ShadingConfig& shading, const TestersConfig& testers) {
  return shading.program.any_hit() && testers.any_hit == TestersConfig::AnyHit::kShader;
}

ShadePrograms shade_programs(const ShadingConfig& shading, const ProgramsConfig& programs,
                             const TestersConfig& testers) {
  ShadePrograms out;
  out.any_hit = runs_any_hit_programs(shading, testers);
  std::map<std::pair<std::string, std::size_t>, std::uint32_t> made;
  const auto line = static_cast<std::uint64_t>(shading.instruction_cache.line_bytes);
  for (std::size_t kind = 0; kind < kShaderKinds; ++kind) {
    if (kind == kAnyHitKind && !out.any_hit) continue;
    const std::string& name = shading.program.of(kind);
    const bool built_in = name == ShaderProgramsConfig::kBuiltIn;
    const auto [at, fresh] =
        made.emplace(std::pair{name, built_in ? kind : 0}, static_cast<std::uint32_t>(out.programs.size()));
    out.of_kind[kind] = at->second;
    if (!fresh) continue;
    ProgramFault fault;
    out.programs.push_back(shader_of(name, kind, programs, fault).value());
    const RayProgram& program = out.programs.back();
    out.registers = std::max(out.registers, program.registers);
    out.address.push_back(out.store_bytes);
    const std::uint64_t bytes = program.code.size() * kInstructionBytes;
    out.store_bytes += (bytes + line - 1) / line * line;
  }
  return out;
}

std::size_t vectors_held(const ShadingConfig& shading, const ShadePrograms& programs) {
  constexpr std::size_t kMostVectors = 64;
  const auto room = static_cast<std::size_t>(shading.registers);
  // A machine that the search for the bottleneck makes better has wider vectors, and room for one.
  return std::clamp<std::size_t>(room / (programs.registers * static_cast<std::size_t>(shading.lanes)), 1,
                                 kMostVectors);
}

}  // namespace carousel
