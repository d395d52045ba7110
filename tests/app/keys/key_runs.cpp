#include "tests/app/keys/key_runs.h"

#include <algorithm>
#include <exception>

#include "app/commands/run_command.h"
#include "core/config/schema.h"
#include "core/system/error.h"

namespace carousel {

using Json = KeyOutcome::Json;

namespace {

/// The report without the configuration and the list of its ignored keys, without values that repeat it, and without
/// times of the host.
std::string result_of(Json report) {
  Json host = report["host"];
  report.erase("config");
  report.erase("ignored_keys");
  report.erase("checksum");  // it covers the configuration as well
  report.erase("host");
  if (report.contains("shading")) report["shading"].erase("workers");
  if (report.contains("links") && report["links"].is_array())
    for (Json& link : report["links"]) link.erase("depth");
  if (report.contains("bytes"))
    for (Json& row : report["bytes"]) row.erase("width_bytes_per_cycle");
  if (host.contains("ray_queues"))
    for (Json& queue : host["ray_queues"]) queue.erase("depth");
  return report.dump() + host.value("simd", "") + host.value("threads", Json()).dump() +
         host.value("ray_queues", Json()).dump();
}

}  // namespace

std::vector<std::string> key_leaves() {
  std::vector<std::string> paths, out;
  for (const std::string& path : config::config_key_paths())
    if (path.find(".0.") == path.npos) paths.push_back(path);
  for (const std::string& path : paths)
    if (std::none_of(paths.begin(), paths.end(), [&](const auto& other) { return other.starts_with(path + "."); }))
      out.push_back(path);
  return out;
}

std::vector<std::string> values_of(const KeyRow& row) {
  if (!row.values.empty()) return row.values;
  const std::vector<std::string> names = config::enum_values(row.key);
  return names.empty() ? std::vector<std::string>{"true", "false"} : names;
}

app::ConfigArguments KeyRuns::arguments(BaseMachine machine, const std::vector<std::string>& sets) {
  program_.write("machine.yaml", text(machine));
  return {(program_.folder() / "machine.yaml").string(), sets};
}

KeyOutcome KeyRuns::run(BaseMachine machine, const std::vector<std::string>& sets) {
  program_.write("machine.yaml", text(machine));
  app::RunArguments arguments;
  arguments.config = (program_.folder() / "machine.yaml").string();
  arguments.sets = sets;
  arguments.out = (program_.folder() / "out").string();
  arguments.quiet = arguments.force = arguments.no_html = true;
  try {
    app::run_command(arguments);
  } catch (const ConfigError& error) {
    return {error.what(), "", {}};
  } catch (const std::exception& error) {
    return {"", error.what(), {}};
  }
  Json report = Json::parse(program_.read("out/report.json"));
  Json config = report["config"];
  const std::string picture =
      std::filesystem::exists(program_.folder() / "out/image.png") ? program_.read("out/image.png") : std::string();
  return {"", result_of(std::move(report)) + picture, std::move(config)};
}

}  // namespace carousel
