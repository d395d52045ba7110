#include "app/sweep/plan/point.h"

#include <algorithm>
#include <map>
#include <set>
#include <thread>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "core/config/write.h"
#include "core/numeric/bytes_digest.h"
#include "core/system/error.h"
#include "report/text/singular.h"

namespace carousel::app {

namespace {

constexpr std::size_t kShownErrors = 10, kShownKeys = 8;

/// The assignments of one key. A scene replaces the whole section, since file and builtin exclude each other.
std::string assignment(const KeyValue& key) {
  constexpr std::string_view kBuiltin = "builtin:";
  if (key.first != "scene") return key.first + "=" + key.second;
  if (key.second.rfind(kBuiltin, 0) == 0) return "scene={builtin: " + key.second.substr(kBuiltin.size()) + "}";
  return "scene={file: " + nlohmann::json(key.second).dump() + "}";
}

}  // namespace

std::string SweepPoint::text() const {
  std::string out;
  for (std::size_t i = 0; i < std::min(keys.size(), kShownKeys); ++i)
    out += (out.empty() ? "" : ", ") + keys[i].first + "=" + keys[i].second;
  if (keys.size() > kShownKeys) out += report::singular(fmt::format(" and {} more keys", keys.size() - kShownKeys));
  return out.empty() ? "the configuration itself" : out;
}

std::string scene_group(const Config& config) {
  if (config.workload.kind == WorkloadConfig::Kind::kTraffic) return "traffic";
  if (config.workload.kind == WorkloadConfig::Kind::kMemoryTrace) return "memory";
  nlohmann::ordered_json json = config_json(config);
  // Everything but the sections that only the simulation reads, so that a new section is safe.
  for (const char* section : {"topology", "rays", "packets", "collections", "bundles", "testers", "memory", "faults",
                              "report", "verify", "vary", "workload", "primary"})
    json.erase(section);
  for (const char* key : {"samples", "max_depth", "seed"}) json["image"].erase(key);
  json["engine"] = {{"simd", json["engine"]["simd"]}};
  json["shading"] = {{"effects", json["shading"]["effects"]}};
  return json.dump();
}

std::size_t point_threads(const Config& config) {
  const std::int64_t automatic =
      config.engine.kind == EngineKind::kCycle ? 1 : std::max(1u, std::thread::hardware_concurrency());
  return static_cast<std::size_t>(config.engine.threads.value_or(automatic));
}

PointMaker::PointMaker(ConfigText source, std::filesystem::path config_folder, std::vector<std::string> sets)
    : source_(std::move(source)),
      sets_(std::move(sets)),
      content_(std::move(config_folder), true),
      program_(program_identity()) {}

SweepPoint PointMaker::make(const Choice& choice) {
  SweepPoint point;
  point.keys = choice;
  for (const KeyValue& key : choice)  // other keys of the section come after the scene
    if (key.first == "scene") point.sets.push_back(assignment(key));
  point.sets.insert(point.sets.end(), sets_.begin(), sets_.end());
  for (const KeyValue& key : choice)
    if (key.first != "scene") point.sets.push_back(assignment(key));
  LocatedConfig located;
  try {
    located = load_config(source_, point.sets);
  } catch (const ConfigError& error) {
    std::vector<ConfigIssue> issues = error.issues();
    for (ConfigIssue& issue : issues) issue.message += " (at the point " + point.text() + ")";
    throw ConfigError(std::move(issues));
  }
  point.threads = point_threads(located.config);
  point.group = scene_group(located.config);
  nlohmann::ordered_json config = config_json(located.config);
  config.erase("vary");
  if (located.config.engine.kind == EngineKind::kCycle) config["engine"].erase("threads");  // changes no result
  const nlohmann::ordered_json all{
      {"program", program_},
      {"config", config},
      {"files", content_.of(located.config.engine, located.config.scene, located.config.bvh, located.config.workload)}};
  point.digest = bytes_digest(all.dump());
  return point;
}

std::vector<SweepPoint> make_points(PointMaker& maker, const std::vector<Choice>& choices) {
  std::vector<SweepPoint> out;
  std::set<std::string> known;
  std::vector<ConfigIssue> issues;
  std::map<std::string, std::size_t> times;  // by message without its point
  for (const Choice& choice : choices) {
    try {
      SweepPoint point = maker.make(choice);
      if (known.insert(point.digest).second) out.push_back(std::move(point));
    } catch (const ConfigError& error) {
      for (const ConfigIssue& issue : error.issues()) {
        const std::string bare = issue.key_path + issue.message.substr(0, issue.message.find(" (at the point "));
        if (++times[bare] == 1) issues.push_back(issue);
      }
    }
  }
  if (issues.empty()) return out;
  for (ConfigIssue& issue : issues) {
    const std::string bare = issue.key_path + issue.message.substr(0, issue.message.find(" (at the point "));
    if (times[bare] > 1) issue.message += report::singular(fmt::format(" and at {} more points", times[bare] - 1));
  }
  if (issues.size() > kShownErrors) {
    const std::size_t more = issues.size() - kShownErrors;
    issues.resize(kShownErrors);
    issues.push_back(
        {{}, "", report::singular(fmt::format("{} more errors of points; --exclude leaves points out", more))});
  } else {
    issues.push_back(
        {{}, "", "nothing was run, since some points are invalid; --exclude KEY=VALUE,... leaves points out"});
  }
  throw ConfigError(std::move(issues));
}

}  // namespace carousel::app
