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
#include "app/inspect/framing.h"
#include "app/inspect/scene_listing.h"
#include "app/run/prepare.h"
#include "core/config/load/load.h"
#include "core/config/schema.h"
#include "core/system/error.h"
#include "core/system/executor.h"
#include "core/types/enum_names.h"
#include "scene/load_scene.h"
#include "scene/place_objects.h"

namespace carousel::app {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kBuiltinScene = "builtin:";

/// The configuration that names the scene; all other keys have their defaults or the values of --set.
LocatedConfig config_for(const InspectArguments& arguments) {
  const std::string& name = arguments.scene;
  Json scene;
  if (name.starts_with(kBuiltinScene))
    scene["builtin"] = name.substr(kBuiltinScene.size());
  else
    scene["file"] = name;
  const Json config{{"schema_version", 1}, {"scene", scene}};
  return load_config({config.dump(), "inspect.json"}, arguments.sets, {.force = true});
}

/// Names what is wrong with the name of a scene, before a configuration is made of it.
void check_name(const std::string& name) {
  if (name.starts_with(kBuiltinScene)) return;
  std::error_code ignored;
  const auto fail = [&](const std::string& why) { throw FileError(fmt::format("{}: {}", name, why)); };
  const std::string ending = std::filesystem::path(name).extension().string();
  const bool there = std::filesystem::is_regular_file(name, ignored);
  if (there && (ending == ".yaml" || ending == ".yml" || ending == ".json"))
    fail(
        fmt::format("is a configuration, by its name; expected a scene file, or {}NAME. carousel check {} shows the "
                    "machine of a configuration, with nodes, links and cuts",
                    kBuiltinScene, name));
  if (there) return;
  if (std::filesystem::is_directory(name, ignored)) fail("is a folder; expected a scene file");
  if (enum_value<BuiltinScene>(name))
    fail(fmt::format("no such file; the built-in scene is carousel inspect {}{}", kBuiltinScene, name));
  fail(fmt::format("no such file; expected a scene file, or {}NAME with one of {}", kBuiltinScene,
                   fmt::join(config::enum_values("scene.builtin"), ", ")));
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
  scene::place_objects(scene, located.config.scene, located.config.primitives, located.config.programs);
  if (!arguments.frame.empty()) {
    const Framing framing = frame_node(scene, arguments.frame, view_of(located.config).aspect);
    print_result(arguments.json ? framing_json(framing).dump(2) + "\n" : framing_yaml(framing));
    return kDone;
  }
  shading::strip_effects(scene, choice);
  report::Shading shading;
  add_effects(shading, scene, located.config);
  if (arguments.json)
    print_result(listing_json(scene, shading).dump(2) + "\n");
  else
    print_text(listing_text(scene, shading));
  return kDone;
}

}  // namespace carousel::app
