#include "app/commands/inspect_command.h"

#include <algorithm>
#include <filesystem>
#include <thread>

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include "app/build_report/effects.h"
#include "app/host/exit_status.h"
#include "app/host/output.h"
#include "app/run/prepare.h"
#include "core/config/load/load.h"
#include "core/config/schema.h"
#include "core/system/error.h"
#include "core/system/executor.h"
#include "core/types/enum_names.h"
#include "report/text/number_text.h"
#include "scene/load_scene.h"

namespace carousel::app {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kBuiltin = "builtin:";

/// The configuration that names the scene; all other keys have their defaults or the values of --set.
LocatedConfig config_for(const InspectArguments& arguments) {
  const std::string& name = arguments.scene;
  Json scene;
  if (name.starts_with(kBuiltin))
    scene["builtin"] = name.substr(kBuiltin.size());
  else
    scene["file"] = name;
  const Json config{{"schema_version", 1}, {"scene", scene}};
  return load_config({config.dump(), "inspect.json"}, arguments.sets, {.force = true});
}

/// Names what is wrong with the name of a scene, before a configuration is made of it.
void check_name(const std::string& name) {
  std::error_code ignored;
  if (name.starts_with(kBuiltin) || std::filesystem::is_regular_file(name, ignored)) return;
  const auto fail = [&](const std::string& why) { throw FileError(fmt::format("{}: {}", name, why)); };
  if (std::filesystem::is_directory(name, ignored)) fail("is a folder; expected a glTF file");
  if (enum_value<BuiltinScene>(name))
    fail(fmt::format("no such file; the built-in scene is carousel inspect {}{}", kBuiltin, name));
  fail(fmt::format("no such file; expected a glTF file, or {}NAME with one of {}", kBuiltin,
                   fmt::join(config::enum_values("scene.builtin"), ", ")));
}

/// Lists the contents of the file, without the camera and the lights that the program adds.
struct Holdings {
  std::uint64_t triangles = 0, instanced = 0, spheres = 0, image_bytes = 0, materials = 0, lights = 0, cameras = 0;
};

Holdings holdings(const scene::Scene& s) {
  Holdings out{.triangles = s.unique_triangle_count(),
               .instanced = s.instanced_triangle_count(),
               .materials = s.materials.size() - (s.added.material ? 1 : 0),
               .lights = s.lights.size() - (s.added.sun ? 1 : 0),
               .cameras = s.cameras.size() - (s.added.camera ? 1 : 0)};
  for (const scene::Mesh& mesh : s.meshes) out.spheres += mesh.spheres.size();
  for (const scene::Image& image : s.images) out.image_bytes += image.rgba.size();
  return out;
}

Json json_of(const scene::Scene& s, const report::Shading& shading) {
  const Holdings h = holdings(s);
  Json effects = Json::array(), classes = Json::array();
  for (const report::Effect& e : shading.effects) {
    effects.push_back({{"name", e.name},
                       {"on", e.on},
                       {"called_for", e.called_for},
                       {"callers", e.callers},
                       {"why", e.why},
                       {"cost",
                        {{"rays", e.cost.rays},
                         {"texture_reads", e.cost.texture_reads},
                         {"path_state_bytes", e.cost.path_state_bytes},
                         {"cycles_per_hit", e.cost.cycles_per_hit},
                         {"cycles_per_path", e.cost.cycles_per_path}}}});
  }
  for (const report::ShaderClass& c : shading.classes)
    classes.push_back({{"name", c.name}, {"materials", c.materials}});
  return {{"scene",
           {{"name", s.name},
            {"triangles", h.triangles},
            {"instanced_triangles", h.instanced},
            {"spheres", h.spheres},
            {"meshes", s.meshes.size()},
            {"instances", s.instances.size()},
            {"materials", h.materials},
            {"textures", s.textures.size()},
            {"images", s.images.size()},
            {"image_bytes", h.image_bytes},
            {"lights", h.lights},
            {"cameras", h.cameras}}},
          {"made_up",
           {{"camera", s.added.camera ? s.cameras[0].name : ""}, {"sun", s.added.sun}, {"material", s.added.material}}},
          {"effects_choice", shading.effects_choice},
          {"effects", effects},
          {"classes", classes},
          {"path_state_bytes", shading.path_state_bytes},
          {"saved",
           {{"path_state_bytes", shading.saved.path_state_bytes},
            {"images_not_decoded", shading.saved.images_not_decoded}}}};
}

std::string cost_text(const report::EffectCost& cost) {
  std::string text;
  const auto add = [&](std::uint64_t count, const char* what) {
    if (count > 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, what);
  };
  add(cost.rays, "rays a path");
  add(cost.texture_reads, "lookups a hit");
  add(cost.path_state_bytes, "bytes a path");
  add(cost.cycles_per_hit, "cycles a hit");
  add(cost.cycles_per_path, "cycles a path");
  return text;
}

std::string table_of(const scene::Scene& s, const report::Shading& shading) {
  const Holdings h = holdings(s);
  std::string out = fmt::format(
      "scene        {}: {} triangles, {} with instances, {} spheres; {} meshes, {} instances\n"
      "             {} materials, {} textures, {} images of {}, {} lights, {} cameras\n",
      s.name, report::grouped(h.triangles), report::grouped(h.instanced), h.spheres, s.meshes.size(),
      s.instances.size(), h.materials, s.textures.size(), s.images.size(), report::bytes_text(h.image_bytes), h.lights,
      h.cameras);
  if (s.added.camera || s.added.sun)
    out += fmt::format("made up      {}{}{}\n",
                       !s.added.camera  ? ""
                       : s.added.inside ? "a camera that stands inside the model (the file has none)"
                                        : "a camera that shows the whole model (the file has none)",
                       s.added.camera && s.added.sun ? "; " : "",
                       s.added.sun ? "a sun (the file has no light that could show it)" : "");
  out += "\n";
  out += fmt::format("{:<28}{:<5}{:<52}{}\n", "effect", "", "cost", "why");
  for (const report::Effect& e : shading.effects)
    out += fmt::format("{:<28}{:<5}{:<52}{}\n", e.name, e.on ? "on" : "off", cost_text(e.cost), e.why);
  out += "\nsurfaces     ";
  for (const report::ShaderClass& c : shading.classes) out += fmt::format("{} {}   ", c.materials, c.name);
  out += fmt::format("\npath state   {} bytes, {} fewer than all effects take\n", shading.path_state_bytes,
                     shading.saved.path_state_bytes);
  if (shading.saved.images_not_decoded > 0)
    out += fmt::format("images       {} are read by no effect, and not decoded\n", shading.saved.images_not_decoded);
  return out;
}

}  // namespace

int inspect_command(const InspectArguments& arguments) {
  check_name(arguments.scene);
  const LocatedConfig located = config_for(arguments);
  const ShadingConfig::Effects& choice = located.config.shading.effects;
  scene::Scene scene = scene::load_scene(
      located.config.scene, {}, [](const std::string& w) { spdlog::warn("{}", w); },
      [&](const scene::Scene& s) { return shading::images_read(s, choice); }, view_of(located.config),
      make_executor(std::max(1u, std::thread::hardware_concurrency())).get());
  shading::strip_effects(scene, choice);
  report::Shading shading;
  add_effects(shading, scene, located.config);
  if (arguments.json)
    print_result(json_of(scene, shading).dump(2) + "\n");
  else
    print_text(table_of(scene, shading));
  return kDone;
}

}  // namespace carousel::app
