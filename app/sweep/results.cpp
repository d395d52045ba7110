#include "app/sweep/results.h"

#include <algorithm>

#include <fmt/format.h>

#include "core/system/error.h"
#include "core/text/edit_distance.h"

namespace carousel::app {

using Json = nlohmann::ordered_json;

namespace {

/// A name of an object or an index of a list, step by step.
const Json* at_path(const Json& report, const std::string& path) {
  const Json* at = &report;
  for (std::size_t begin = 0; begin <= path.size();) {
    const std::size_t end = std::min(path.find('.', begin), path.size());
    const std::string name = path.substr(begin, end - begin);
    begin = end + 1;
    if (at->is_object() && at->contains(name)) {
      at = &(*at)[name];
    } else if (at->is_array() && !name.empty() && name.size() < 8 &&
               name.find_first_not_of("0123456789") == name.npos && std::stoul(name) < at->size()) {
      at = &(*at)[std::stoul(name)];
    } else {
      return nullptr;
    }
  }
  return at;
}

/// The gain of the class that limits the machine.
Json gain_of_verdict(const Json& report) {
  const Json *limits = at_path(report, "bottleneck.limits"), *gains = at_path(report, "bottleneck.gains");
  if (limits == nullptr || gains == nullptr) return nullptr;
  for (const Json& gain : *gains)
    if (gain["name"] == *limits) return gain["gain"];
  return nullptr;
}

/// The estimate for the whole frame where the point simulated a part of it; null if there is none.
Json estimate_of(const std::string& column, const Json& report) {
  const auto estimate = [&](const char* name) -> Json {
    const Json* at = at_path(report, std::string("sampled.") + name + ".estimate");
    return at == nullptr ? Json() : *at;
  };
  if (column == "cycles") return estimate("cycles");
  if (column == "nj_per_ray") return estimate("nj_per_ray");
  const Json rate = estimate("rays_per_kilocycle");
  if (column == "rays_per_kilocycle") return rate;
  const Json *clock = at_path(report, "config.engine.clock_mhz"), *mm2 = at_path(report, "area.mm2");
  if (!rate.is_number() || clock == nullptr) return nullptr;
  const double mrays = rate.get<double>() * clock->get<double>() / 1000;
  if (column == "mrays_per_second") return mrays;
  if (column == "mrays_per_second_per_mm2" && mm2 != nullptr) return mrays / mm2->get<double>();
  return nullptr;
}

Json all_bytes(const Json& report) {
  const Json* bytes = at_path(report, "bytes");
  if (bytes == nullptr) return nullptr;
  std::uint64_t sum = 0, memory = 0, moved = 0;
  for (const Json& row : *bytes) {
    const auto sent = row["bytes"].get<std::uint64_t>();
    sum += sent;
    if (row["from"] == "DRAM" || row["to"] == "DRAM") memory += sent;
    if (row["what"] == "lines" || row["what"] == "written lines") moved += sent;
  }
  const Json *rays = at_path(report, "sampled.rays.estimate"), *simulated = at_path(report, "rays.completed"),
             *each = at_path(report, "sampled.memory_bytes_per_ray.estimate");
  if (rays == nullptr || simulated == nullptr || each == nullptr) return sum;
  // The frame sends as many bytes more as it has more rays, but those of the memory do not grow so.
  const double frame = rays->get<double>(), times = frame / simulated->get<double>();
  const double of_memory = moved > 0 ? each->get<double>() * frame / static_cast<double>(moved) : times;
  return static_cast<double>(sum - memory) * times + static_cast<double>(memory) * of_memory;
}

}  // namespace

std::vector<ResultColumn> result_columns(const std::vector<std::string>& paths) {
  using enum ResultOf;
  std::vector<ResultColumn> out{{"cycles", "engine.cycles", false, kCycleRun},
                                {"rays_per_kilocycle", "throughput.whole.rays_per_kilocycle", true, kCycleRun},
                                {"mrays_per_second", "throughput.whole.mrays_per_second_at_clock", true, kCycleRun},
                                {"limits", "bottleneck.limits", false, kCycleRun},
                                {"gain", "", false, kCycleRun},
                                {kNoiseColumn, "cycle_noise.fraction", false, kCycleRun},
                                {"bytes", "", false, kCycleRun},
                                {"tests_per_ray", "throughput.tests_per_ray"},
                                {"nj_per_ray", "energy.nj_per_ray", false, kCostProfile},
                                {"mm2", "area.mm2", false, kCostProfile},
                                {"mrays_per_second_per_mm2", "area.mrays_per_second_per_mm2", true, kCostProfile},
                                {"host_rays_per_second", "host.rays_per_second", true, kNativeRun}};
  for (const std::string& path : paths) out.push_back({path, path, path.find("rays_per") != path.npos, kEveryRun});
  return out;
}

Json result_of(const ResultColumn& column, const Json& report) {
  if (column.path.empty()) return column.name == "gain" ? gain_of_verdict(report) : all_bytes(report);
  if (const Json estimate = estimate_of(column.name, report); !estimate.is_null()) return estimate;
  const Json* at = at_path(report, column.path);
  if (at == nullptr) return nullptr;
  // The host's rate is the result of a native run, and noise beside simulated cycles.
  if (column.name == "host_rays_per_second" && at_path(report, "engine.cycles") != nullptr) return nullptr;
  return at->is_object() || at->is_array() ? Json(at->dump()) : *at;
}

std::size_t SweepRows::column(const std::string& name, const std::string& option) const {
  std::vector<std::string> names;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    if (columns[i].name == name) return i;
    names.push_back(columns[i].name);
  }
  const auto near = nearest_name(name, names);
  throw ConfigError({{{option, 0, 0},
                      name,
                      fmt::format("no such result{}; known are {}; --result adds one of the report",
                                  near ? ", did you mean " + *near + "?" : "", fmt::join(names, ", "))}});
}

void SweepRows::require_result(std::size_t column, const Config& base, const std::string& option) const {
  const ResultOf of = columns[column].of;
  const auto require = [&](const std::string& key, bool met, const std::string& expected, const std::string& found) {
    if (met || std::find(keys.begin(), keys.end(), key) != keys.end()) return;
    throw ConfigError({{{option, 0, 0},
                        key,
                        fmt::format("{} is a result of runs with {}={}; expected --set {}={}, found {}",
                                    columns[column].name, key, expected, key, expected, found)}});
  };
  const EngineKind kind = base.engine.kind;
  const std::string engine{enum_name(kind)};
  if (of == ResultOf::kNativeRun) require("engine.kind", kind == EngineKind::kNative, "native", engine);
  if (of == ResultOf::kCycleRun || of == ResultOf::kCostProfile)
    require("engine.kind", kind == EngineKind::kCycle, "cycle", engine);
  if (of == ResultOf::kCostProfile) require("energy.profile", base.energy.profile != CostProfile::kNone, "n7", "none");
}

std::optional<double> SweepRows::number(const SweepRow& row, std::size_t column) const {
  if (row.error || column >= row.results.size() || !row.results[column].is_number()) return std::nullopt;
  return row.results[column].get<double>();
}

void SweepRows::drop_empty(const std::vector<std::string>& kept) {
  for (std::size_t i = columns.size(); i-- > 0;) {
    if (std::find(kept.begin(), kept.end(), columns[i].name) != kept.end()) continue;
    const bool any = std::any_of(rows.begin(), rows.end(), [&](const SweepRow& row) {
      return i < row.results.size() && !row.results[i].is_null();
    });
    if (any) continue;
    columns.erase(columns.begin() + static_cast<std::ptrdiff_t>(i));
    for (SweepRow& row : rows)
      if (i < row.results.size()) row.results.erase(row.results.begin() + static_cast<std::ptrdiff_t>(i));
  }
}

std::size_t SweepRows::failed() const {
  return static_cast<std::size_t>(
      std::count_if(rows.begin(), rows.end(), [](const SweepRow& row) { return row.finished && row.error; }));
}

std::size_t SweepRows::done() const {
  return static_cast<std::size_t>(
      std::count_if(rows.begin(), rows.end(), [](const SweepRow& row) { return row.finished && !row.error; }));
}

void fill_row(SweepRow& row, const std::vector<ResultColumn>& columns, const PointFile& file) {
  row.finished = true;
  row.error = file.error;
  row.seconds = file.seconds;
  row.results.clear();
  if (!file.report.is_object()) return;
  for (const ResultColumn& column : columns) row.results.push_back(result_of(column, file.report));
}

}  // namespace carousel::app
