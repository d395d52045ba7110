#include "core/config/load/load.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <map>
#include <tuple>
#include <utility>

#include <fmt/format.h>

#include "core/config/graph/clocks.h"
#include "core/config/graph/graph.h"
#include "core/config/reader.h"
#include "core/config/tree/tree.h"
#include "core/plugin/open_plugin.h"
#include "core/system/input_file.h"

namespace carousel {

namespace {

/// True if one of the two paths encloses the other. The empty path encloses all.
bool related(std::string_view a, std::string_view b) {
  if (a.empty() || b.empty()) return true;
  const std::size_t shorter = std::min(a.size(), b.size());
  if (a.substr(0, shorter) != b.substr(0, shorter)) return false;
  return a.size() == b.size() || (a.size() > b.size() ? a : b)[shorter] == '.';
}

/// In the order of the file; what --set brought comes last.
void sort_by_position(std::vector<ConfigIssue>& issues, const std::string& file) {
  const auto rank = [&](const ConfigIssue& issue) {
    const SourcePosition& at = issue.position;
    return std::tuple(at.file != file, at.line, at.column);
  };
  std::stable_sort(issues.begin(), issues.end(),
                   [&](const ConfigIssue& a, const ConfigIssue& b) { return rank(a) < rank(b); });
}

/// The testers of all resources, from which an override of one resource starts.
TestersConfig read_base_testers(const config::Node& root) {
  TestersConfig testers;
  std::vector<ConfigIssue> ignored;  // reported when the section is read for good
  if (const config::Node* node = root.find("testers")) config::Reader(ignored, {}).read(*node, testers);
  return testers;
}

/// A shape may imply a value where the file says nothing: point_to_point has no other visits than those of owners, a
/// graph would hardly have, and its nodes are its resources, by whose names overrides may go. The clock of the
/// resources has two names.
void imply(const config::Node& root, Config& config) {
  const config::Node* engine = root.find("engine");
  if (config.clocks.core && (engine == nullptr || engine->find("clock_mhz") == nullptr))
    config.engine.clock_mhz = *config.clocks.core;
  const config::Node* topology = root.find("topology");
  const bool graph = config.topology.shape == TopologyShape::kGraph;
  if ((graph || config.topology.shape == TopologyShape::kPointToPoint) && topology->find("visit") == nullptr)
    config.topology.visit = Visit::kOwners;
  if (!graph) return;
  config::name_overrides(config.topology);
  config::name_clocks(config.topology, {config.clocks, config.engine.clock_mhz},
                      config.workload.kind == WorkloadConfig::Kind::kTraffic);
  if (topology->find("resources") != nullptr) return;
  const std::int64_t drawn = config::drawn_resources(config.topology);
  config.topology.resources = std::clamp<std::int64_t>(drawn, 1, config::kMaxResources);
}

/// Takes `$schema` away, by which a file tells editors where the schema is; it says nothing about the machine.
void skip_schema_line(config::Node& root, std::vector<ConfigIssue>& issues) {
  const auto line = std::find_if(root.members.begin(), root.members.end(),
                                 [](const config::Member& member) { return member.key == "$schema"; });
  if (line == root.members.end()) return;
  if (line->value.kind != config::Node::Kind::kString)
    issues.push_back(
        {line->value.position, "$schema", "expected the address of the schema, found " + line->value.found()});
  root.members.erase(line);
}

/// Opens the plugins that the tree names, in the order of the list, and returns their files: their names count in what
/// is read next. The reader names the faults of the list itself.
std::vector<std::string> open_plugins(const config::Node& root, const std::string& source,
                                      std::vector<ConfigIssue>& issues) {
  std::vector<std::string> files;
  std::map<std::pair<std::string, std::string>, std::string> seen;  // what and name, and the file that has brought it
  const config::Node* const engine = root.find("engine");
  const config::Node* const list = engine == nullptr ? nullptr : engine->find("plugins");
  for (std::size_t i = 0; list != nullptr && i < list->items.size(); ++i) {
    const config::Node& item = list->items[i];
    if (item.text.empty()) continue;
    const auto wrong = [&](std::string message) {
      issues.push_back({item.position, fmt::format("engine.plugins.{}", i), std::move(message)});
    };
    const std::filesystem::path file = plugin_file(std::filesystem::path(source).parent_path(), item.text);
    if (std::error_code ignored; !std::filesystem::exists(file, ignored)) {
      wrong(
          fmt::format("expected a plugin beside the configuration or in the working directory, found '{}', which is "
                      "not there",
                      item.text));
      continue;
    }
    try {
      const Plugin& plugin = open_plugin(file);
      if (std::find(files.begin(), files.end(), plugin.file.string()) != files.end()) {
        wrong(fmt::format("the plugin {} is named twice", plugin.file.string()));
        continue;
      }
      files.push_back(plugin.file.string());
      for (const Plugin::Part& part : plugin.parts)
        if (const auto [other, added] = seen.emplace(std::pair(part.what, part.name), files.back()); !added)
          wrong(fmt::format("{} brings a {} of the name {}, which {} has brought", files.back(), part.what, part.name,
                            other->second));
    } catch (const PluginError& error) {
      wrong(error.what());
    }
  }
  return files;
}

LocatedConfig read_fields(const ConfigText& source, std::span<const std::string> sets,
                          std::vector<ConfigIssue>& issues) {
  config::Node root = config::parse_tree(source.text, source.name, issues);
  if (root.kind == config::Node::Kind::kNull) root.kind = config::Node::Kind::kMap;  // an empty file
  skip_schema_line(root, issues);
  if (root.kind == config::Node::Kind::kMap)
    for (const std::string& set : sets) config::apply_set(root, set, issues);
  LocatedConfig out{{}, KeyPositions(root, source.name)};
  out.plugins = open_plugins(root, source.name, issues);
  config::Reader(issues, read_base_testers(root), out.plugins).read(root, out.config);
  imply(root, out.config);
  return out;
}

/// Appends the breaches of the rules across fields. A field that could not be read has its default, which is not
/// judged, nor are the names of a drawing whose nodes could not be read.
void check_rules(const LocatedConfig& located, const ValidateOptions& options, std::vector<ConfigIssue>& issues) {
  const std::size_t unread = issues.size();
  for (ConfigIssue& issue : validate_config(located.config, located.positions, options)) {
    const bool about_unread = std::any_of(issues.begin(), issues.begin() + std::ptrdiff_t(unread), [&](const auto& r) {
      return related(r.key_path, issue.key_path) ||
             (r.key_path.starts_with("topology.nodes") && issue.key_path.starts_with("topology."));
    });
    if (!about_unread) issues.push_back(std::move(issue));
  }
}

}  // namespace

ConfigText read_config_file(const std::filesystem::path& path) {
  const auto fail = [&](const std::string& why) {
    throw ConfigError({{{path.string(), 0, 0}, "", "cannot be read: " + why}});
  };
  if (std::error_code ignored; std::filesystem::is_directory(path, ignored)) fail("it is a folder");
  errno = 0;
  InputFile stream(path);
  if (!stream) fail(std::strerror(errno));
  std::string text(config::kMaxBytes + 1, '\0');  // one more than allowed, so that too much is seen
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(stream.gcount()));
  return {std::move(text), path.string()};
}

LocatedConfig load_config(const ConfigText& source, std::span<const std::string> sets, const ValidateOptions& options) {
  std::vector<ConfigIssue> issues;
  LocatedConfig located = read_fields(source, sets, issues);
  if (!options.fields_only) check_rules(located, options, issues);
  if (issues.empty()) return located;
  sort_by_position(issues, source.name);
  throw ConfigError(std::move(issues));
}

}  // namespace carousel
