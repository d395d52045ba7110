#include "app/plugins/plugins.h"

#include "core/plugin/open_plugin.h"
#include "core/system/error.h"

namespace carousel::app {

std::vector<std::string> open_plugins(const std::vector<std::string>& names) {
  std::vector<std::string> out;
  for (const std::string& name : names) {
    try {
      out.push_back(open_plugin(name).file.string());
    } catch (const PluginError& error) {
      throw ConfigError("--plugin", error.what());
    }
  }
  return out;
}

std::optional<std::vector<report::Plugin>> plugins_section(const std::vector<std::string>& files) {
  if (files.empty()) return std::nullopt;
  std::vector<report::Plugin> out;
  for (const std::string& file : files) {
    const Plugin& plugin = open_plugin(file);
    report::Plugin& section = out.emplace_back();
    section.file = plugin.file.string();
    section.name = plugin.name;
    section.version = plugin.version;
    section.digest = plugin.digest;
    for (const Plugin::Part& part : plugin.parts) section.brings.push_back(part.what + " " + part.name);
  }
  return out;
}

}  // namespace carousel::app
