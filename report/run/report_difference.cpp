#include "report/run/report_difference.h"

#include <algorithm>
#include <filesystem>
#include <utility>

namespace carousel::report {

namespace {

using Json = nlohmann::ordered_json;

using Reports = std::vector<const Json*>;

bool all_are(const Reports& values, bool (Json::*is)() const noexcept) {
  return std::all_of(values.begin(), values.end(),
                     [&](const Json* value) { return value != nullptr && (value->*is)(); });
}

bool all_equal(const Reports& values) {
  return std::all_of(values.begin(), values.end(), [&](const Json* value) {
    return value == nullptr ? values.front() == nullptr : values.front() != nullptr && *value == *values.front();
  });
}

const Json* item_of(const Json& array, std::size_t i) {
  return i < array.size() ? &array[i] : nullptr;
}

/// True for a list that is too long to be told value by value.
bool is_series(const Reports& values) {
  constexpr std::size_t kMostValues = 64;
  return std::any_of(values.begin(), values.end(),
                     [](const Json* value) { return value->size() > kMostValues && !value->front().is_structured(); });
}

void compare(const std::string& path, const Reports& values, std::vector<ManyDifference>& out) {
  if (all_equal(values)) return;
  const auto child = [&](const std::string& key) { return path.empty() ? key : path + "." + key; };
  Reports below(values.size());
  if (all_are(values, &Json::is_object)) {
    std::vector<std::string> keys;
    for (const Json* value : values)
      for (const auto& [key, ignored] : value->items())
        if (std::find(keys.begin(), keys.end(), key) == keys.end()) keys.push_back(key);
    for (const std::string& key : keys) {
      for (std::size_t r = 0; r < values.size(); ++r)
        below[r] = values[r]->contains(key) ? &(*values[r])[key] : nullptr;
      compare(child(key), below, out);
    }
    return;
  }
  if (all_are(values, &Json::is_array)) {
    std::size_t most = 0;
    for (const Json* value : values) most = std::max(most, value->size());
    const bool series = is_series(values);
    const std::size_t before = out.size();
    for (std::size_t i = 0; i < most && !(series && out.size() > before); ++i) {
      for (std::size_t r = 0; r < values.size(); ++r) below[r] = item_of(*values[r], i);
      compare(child(std::to_string(i)), below, out);
    }
    return;
  }
  ManyDifference& difference = out.emplace_back(ManyDifference{path, {}});
  for (const Json* value : values) difference.values.push_back(value != nullptr ? value->dump() : "");
}

/// A text that begins with the name of a file, without the file's folder.
void leave_folder_out(Json& text) {
  if (!text.is_string()) return;
  const std::string whole = text.get<std::string>();
  const std::size_t end = std::min(whole.find(": "), whole.size());
  text = std::filesystem::path(whole.substr(0, end)).filename().string() + whole.substr(end);
}

/// In which folders a host has the files is its affair.
void leave_folders_out(Json& report) {
  if (const Json::json_pointer at("/config/engine/plugins"); report.contains(at) && report[at].is_array())
    for (Json& plugin : report[at]) leave_folder_out(plugin);
  if (report.contains("plugins") && report["plugins"].is_array())
    for (Json& plugin : report["plugins"])
      if (plugin.is_object() && plugin.contains("file")) leave_folder_out(plugin["file"]);
  for (const char* file : {"/config/scene/file", "/config/workload/rays_from", "/config/workload/memory_trace"})
    if (const Json::json_pointer at(file); report.contains(at) && report[at].is_string())
      report[at] = std::filesystem::path(report[at].get<std::string>()).filename().string();
  if (const Json::json_pointer at("/scene/warnings"); report.contains(at) && report[at].is_array())
    for (Json& warning : report[at]) leave_folder_out(warning);
}

}  // namespace

std::vector<ManyDifference> differences(const std::vector<const Json*>& reports) {
  std::vector<Json> copies;
  copies.reserve(reports.size());
  Reports values;
  for (const Json* report : reports) {
    Json& copy = copies.emplace_back(*report);
    copy.erase("host");
    // How many threads the host was to use is its affair too.
    if (const auto engine = Json::json_pointer("/config/engine"); copy.contains(engine)) copy[engine].erase("threads");
    leave_folders_out(copy);
    values.push_back(&copy);
  }
  std::vector<ManyDifference> out;
  compare("", values, out);
  return out;
}

std::vector<Difference> differences(const Json& a, const Json& b) {
  std::vector<Difference> out;
  for (ManyDifference& one : differences({&a, &b}))
    out.push_back({std::move(one.path), std::move(one.values[0]), std::move(one.values[1])});
  return out;
}

EpochRange first_differing_epoch(const Json& a, const Json& b) {
  const Json::json_pointer at("/engine/epochs");
  if (!a.contains(at) || !b.contains(at)) return {};
  const std::size_t each = a[at].value("cycles_each", std::size_t{0});
  // Runs of very different length have epochs of different length; then the first one is as good as any.
  if (each != b[at].value("cycles_each", std::size_t{0})) return {true, 0, each};
  const Json &left = a[at]["digests"], &right = b[at]["digests"];
  for (std::size_t i = 0; i < std::max(left.size(), right.size()); ++i)
    if (i >= left.size() || i >= right.size() || left[i] != right[i]) return {true, i * each, (i + 1) * each};
  return {};
}

}  // namespace carousel::report
