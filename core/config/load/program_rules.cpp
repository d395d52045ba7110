#include "core/config/load/program_rules.h"

#include <algorithm>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "core/config/own_sections.h"
#include "core/config/primitive_program.h"
#include "core/config/shader_programs.h"
#include "core/text/edit_distance.h"

namespace carousel::config {

namespace {

/// True if an instruction that compiles loads this parameter, which is its last word then.
bool loads(std::string_view instruction, std::string_view parameter) {
  constexpr std::string_view kBetween = " \t,";
  const auto word = [&](std::size_t from) { return instruction.find_first_not_of(kBetween, from); };
  const std::size_t first = word(0), last = instruction.find_last_not_of(kBetween);
  if (first == instruction.npos || !instruction.substr(first).starts_with("load")) return false;
  const std::size_t before = instruction.find_last_of(kBetween, last);
  return instruction.substr(before + 1, last - before) == parameter;
}

const std::string kAnyHitKey = fmt::format("shading.program.{}", kShaderKindNames[kAnyHitKind]);
constexpr std::int64_t kLeastPage = 4096;

class ProgramRules {
 public:
  ProgramRules(const Config& config, const KeyPositions& positions, std::vector<ConfigIssue>& issues)
      : c_(config), positions_(positions), issues_(issues) {}

  void check() {
    for (const auto& [name, primitive] : c_.primitives.named) primitive_is_whole(name, primitive);
    for (std::size_t i = 0; i < c_.scene.objects.size(); ++i) object_has_a_primitive(i);
    if (!c_.scene.objects.empty() && c_.engine.kind == EngineKind::kCycle) one_unit_a_program();
    const std::size_t before = issues_.size();
    shaders_are_whole();
    if (!shaders_are_known() || issues_.size() != before) return;
    every_shader_is_named();
    any_hit_calls_send_no_rays();
    if (issues_.size() == before) workers_hold_their_programs();
  }

 private:
  void issue(const std::string& key, std::string message) {
    issues_.push_back({positions_.find(key), key, std::move(message)});
  }

  bool name_is_plain(const std::string& key, const std::string& name) {
    const auto plain = [](char c) {
      return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || (c >= '0' && c <= '9');
    };
    if (std::all_of(name.begin(), name.end(), plain)) return true;
    issue(key, fmt::format("expected a name of letters, digits and _, found '{}'", name));
    return false;
  }

  void primitive_is_whole(const std::string& name, const PrimitiveConfig& primitive) {
    const std::string key = "primitives." + name;
    if (!name_is_plain(key, name)) return;
    for (int axis = 0; axis < 3; ++axis)
      if (!(primitive.bounds.low[axis] < primitive.bounds.high[axis]))
        return issue(key + ".bounds",
                     fmt::format("expected low below high along each axis, found {} and {} along {}",
                                 primitive.bounds.low[axis], primitive.bounds.high[axis], "xyz"[axis]));
    ProgramFault fault;
    if (program_of(primitive, c_.programs, fault))
      every_parameter_is_loaded(key, primitive.program, primitive.parameters);
    else
      at_its_word(key, primitive.program, std::move(fault));
  }

  void at_its_word(const std::string& key, const std::vector<std::string>& program, ProgramFault fault) {
    const std::string line = program.empty() ? key + ".program" : fmt::format("{}.program.{}", key, fault.line);
    SourcePosition at = positions_.find(line);
    if (at.column > 0) at.column += static_cast<int>(fault.column);
    issues_.push_back({std::move(at), line, std::move(fault.message)});
  }

  void every_parameter_is_loaded(const std::string& key, const std::vector<std::string>& program,
                                 const ProgramParameters& parameters) {
    for (const auto& parameter : parameters.values) {
      const std::string& name = parameter.first;
      if (std::ranges::none_of(program, [&](const std::string& text) { return loads(text, name); }))
        issue(key + ".parameters." + name,
              "the program loads no number of this name; expected an instruction that does");
    }
  }

  void shaders_are_whole() {
    for (const auto& [name, shader] : c_.programs.shaders.named) {
      const std::string key = "programs.shaders." + name;
      if (!name_is_plain(key, name)) continue;
      ProgramFault fault;
      if (name == ShaderProgramsConfig::kBuiltIn || name == ShaderProgramsConfig::kConstant)
        issue(key, fmt::format("{} is no name for a program of your own; expected another", name));
      else if (shader_of(name, 0, c_.programs, fault))
        every_parameter_is_loaded(key, shader.program, shader.parameters);
      else
        at_its_word(key, shader.program, std::move(fault));
    }
  }

  /// Returns whether all programs that shading.program names are there.
  bool shaders_are_known() {
    const std::size_t before = issues_.size();
    const auto known = [&](const std::string& key, const std::string& name) {
      if (name == ShaderProgramsConfig::kBuiltIn || c_.programs.shaders.named.contains(name)) return;
      const bool may_be_constant = key == kAnyHitKey;
      if (name == ShaderProgramsConfig::kConstant && may_be_constant) return;
      std::vector<std::string> names{std::string(ShaderProgramsConfig::kBuiltIn)};
      if (may_be_constant) names.emplace_back(ShaderProgramsConfig::kConstant);
      for (const auto& [own, shader] : c_.programs.shaders.named) names.push_back(own);
      const auto near = nearest_name(name, names);
      issue(key, fmt::format("expected a name of programs.shaders, or built_in{}, found '{}'{}",
                             may_be_constant ? ", or constant" : "", name,
                             near ? fmt::format("; did you mean '{}'?", *near)
                                  : fmt::format("; known are {}", fmt::join(names, ", "))));
    };
    const ShaderProgramsConfig& program = c_.shading.program;
    if (program.any()) known("shading.program.default", program.standard);
    for (std::size_t kind = 0; kind < kShaderKinds; ++kind) {
      if (program.of_kind[kind].empty()) continue;
      const std::string key = fmt::format("shading.program.{}", kShaderKindNames[kind]);
      if (!program.any())
        issue(key, "work that has no key of its own needs a program too; expected shading.program.default beside it");
      else
        known(key, program.of_kind[kind]);
    }
    return program.any() && issues_.size() == before;
  }

  void every_shader_is_named() {
    const ShaderProgramsConfig& program = c_.shading.program;
    for (const auto& [name, shader] : c_.programs.shaders.named)
      if (program.standard != name && std::ranges::find(program.of_kind, name) == program.of_kind.end())
        issue("programs.shaders." + name, "nothing runs this program; expected a key of shading.program that names it");
  }

  /// The program of any-hit calls, which may be that of other work.
  void any_hit_calls_send_no_rays() {
    if (!runs_any_hit_programs(c_.shading, c_.testers)) return;
    const std::string& name = c_.shading.program.of(kAnyHitKind);
    ProgramFault fault;
    if (!shader_of(name, kAnyHitKind, c_.programs, fault))
      at_its_word("programs.shaders." + name, c_.programs.shaders.named.at(name).program, std::move(fault));
  }

  /// The programs that shader workers run, all of which compile.
  void workers_hold_their_programs() {
    const ShadingConfig& shading = c_.shading;
    const ShadePrograms programs = shade_programs(shading, c_.programs, c_.testers);
    if (programs.registers * static_cast<std::size_t>(shading.lanes) > static_cast<std::size_t>(shading.registers))
      issue("shading.registers",
            fmt::format("the largest program has {} registers for each of {} lanes; expected {} at least, found {}",
                        programs.registers, shading.lanes, programs.registers * static_cast<std::size_t>(shading.lanes),
                        shading.registers));
    if (shading.idle_resources_shade)
      issue("shading.idle_resources_shade",
            "resources have no units that run shader programs, which is not built; expected false with "
            "shading.program, found true");
    const auto reads = [](const RayProgram& program) {
      return std::ranges::any_of(
          program.code, [](const Instruction& i) { return i.of == OpClass::kRead || i.of == OpClass::kTexture; });
    };
    if (has_drawn_caches(c_.topology) && std::ranges::any_of(programs.programs, reads))
      issue("shading.program",
            "caches that are drawn have no ports for data of shader programs yet; expected programs without read and "
            "texture, or no node of the kind cache");
    const InstructionCacheConfig& cache = shading.instruction_cache;
    if (cache.line_bytes % kInstructionBytes != 0)
      issue("shading.instruction_cache.line_bytes",
            fmt::format("expected a multiple of the {} bytes of an instruction, found {}", kInstructionBytes,
                        cache.line_bytes));
    else if (cache.bytes % cache.line_bytes != 0)
      issue("shading.instruction_cache.bytes",
            fmt::format("expected a multiple of line_bytes, which are {}, found {}", cache.line_bytes, cache.bytes));
    data_cache_is_whole();
    pages_are_whole();
  }

  void data_cache_is_whole() {
    const DataCacheConfig& cache = c_.shading.data_cache;
    if (cache.bytes == 0) return;
    const std::int64_t line = cache.line_bytes.value_or(c_.memory.line_bytes);
    if (line % c_.memory.line_bytes != 0)
      issue(
          "shading.data_cache.line_bytes",
          fmt::format("expected a multiple of memory.line_bytes, which are {}, found {}", c_.memory.line_bytes, line));
    else if (cache.bytes % (line * cache.ways) != 0)
      issue("shading.data_cache.bytes", fmt::format("expected a multiple of the {} bytes of {} lines, found {}",
                                                    line * cache.ways, cache.ways, cache.bytes));
  }

  void pages_are_whole() {
    const std::int64_t page = c_.shading.translation.page_bytes, line = c_.memory.line_bytes;
    const DataCacheConfig& cache = c_.shading.data_cache;
    if (page == 0) return;
    if (page < kLeastPage || (page & (page - 1)) != 0)
      issue("shading.translation.page_bytes",
            fmt::format("expected 0, or a power of two from {}, found {}", kLeastPage, page));
    else if (const std::int64_t most = cache.bytes > 0 ? cache.line_bytes.value_or(line) : line; page % most != 0)
      issue("shading.translation.page_bytes", fmt::format("expected whole lines of {} bytes, found {}", most, page));
  }

  void object_has_a_primitive(std::size_t i) {
    const std::string& name = c_.scene.objects[i].primitive;
    if (c_.primitives.named.contains(name)) return;
    std::vector<std::string> names;
    for (const auto& [known, primitive] : c_.primitives.named) names.push_back(known);
    const auto near = nearest_name(name, names);
    issue(fmt::format("scene.objects.{}.primitive", i),
          fmt::format("expected a name of primitives, found '{}'{}", name,
                      near            ? fmt::format("; did you mean '{}'?", *near)
                      : names.empty() ? "; there are none"
                                      : fmt::format("; known are {}", fmt::join(names, ", "))));
  }

  void one_unit_a_program() {
    const auto most = [&](const auto& of) {
      return most_of_resources(c_, [&](const OwnSections& one) { return of(one.testers); });
    };
    if (const auto units = most([](const TestersConfig& t) { return t.units[UnitKind::kProcedural].units; }); units > 1)
      issue("testers.procedural",
            fmt::format("a program runs on one unit from its beginning to its end, and a resource has one such unit; "
                        "expected 1 unit, found {}",
                        units));
    if (const auto lanes = most([](const TestersConfig& t) { return t.simd.lanes; }); lanes > 1)
      issue("testers.simd.lanes",
            fmt::format("lanes in step would wait for the longest of their programs, which is not built; expected 1 "
                        "with scene.objects, found {}",
                        lanes));
  }

  const Config& c_;
  const KeyPositions& positions_;
  std::vector<ConfigIssue>& issues_;
};

}  // namespace

void check_programs(const Config& config, const KeyPositions& positions, std::vector<ConfigIssue>& issues) {
  ProgramRules(config, positions, issues).check();
}

}  // namespace carousel::config
