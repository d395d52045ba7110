#include "core/config/load/program_rules.h"

#include <algorithm>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "core/config/own_sections.h"
#include "core/config/primitive_program.h"
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

class ProgramRules {
 public:
  ProgramRules(const Config& config, const KeyPositions& positions, std::vector<ConfigIssue>& issues)
      : c_(config), positions_(positions), issues_(issues) {}

  void check() {
    for (const auto& [name, primitive] : c_.primitives.named) primitive_is_whole(name, primitive);
    for (std::size_t i = 0; i < c_.scene.objects.size(); ++i) object_has_a_primitive(i);
    if (!c_.scene.objects.empty() && c_.engine.kind == EngineKind::kCycle) one_unit_a_program();
  }

 private:
  void issue(const std::string& key, std::string message) {
    issues_.push_back({positions_.find(key), key, std::move(message)});
  }

  void primitive_is_whole(const std::string& name, const PrimitiveConfig& primitive) {
    const std::string key = "primitives." + name;
    const auto plain = [](char c) {
      return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || (c >= '0' && c <= '9');
    };
    if (!std::all_of(name.begin(), name.end(), plain))
      return issue(key, fmt::format("expected a name of letters, digits and _, found '{}'", name));
    for (int axis = 0; axis < 3; ++axis)
      if (!(primitive.bounds.low[axis] < primitive.bounds.high[axis]))
        return issue(key + ".bounds",
                     fmt::format("expected low below high along each axis, found {} and {} along {}",
                                 primitive.bounds.low[axis], primitive.bounds.high[axis], "xyz"[axis]));
    ProgramFault fault;
    if (program_of(primitive, c_.programs, fault)) return every_parameter_is_loaded(key, primitive);
    const std::string line =
        primitive.program.empty() ? key + ".program" : fmt::format("{}.program.{}", key, fault.line);
    SourcePosition at = positions_.find(line);
    if (at.column > 0) at.column += static_cast<int>(fault.column);
    issues_.push_back({std::move(at), line, std::move(fault.message)});
  }

  void every_parameter_is_loaded(const std::string& key, const PrimitiveConfig& primitive) {
    for (const auto& [name, value] : primitive.parameters.values)
      if (std::ranges::none_of(primitive.program, [&](const std::string& text) { return loads(text, name); }))
        issue(key + ".parameters." + name,
              "the program loads no number of this name; expected an instruction that does");
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
