#include "app/sweep/process/point_file.h"

#include <fstream>
#include <iterator>

#include <spdlog/spdlog.h>

#include "core/system/atomic_file.h"

namespace carousel::app {

using Json = nlohmann::ordered_json;

std::filesystem::path point_path(const std::filesystem::path& out, const std::string& digest) {
  return out / "points" / (digest + ".json");
}

Json value_json(const std::string& text) {
  Json parsed = Json::parse(text, nullptr, false);
  return parsed.is_number() || parsed.is_boolean() ? parsed : Json(text);
}

Json keys_json(const Choice& keys) {
  Json out = Json::object();
  for (const KeyValue& key : keys) out[key.first] = value_json(key.second);
  return out;
}

void write_point(const std::filesystem::path& out, const SweepPoint& point, double seconds,
                 const std::optional<PointError>& error, const Json& report) {
  Json json{{"schema_version", 1}, {"point", point.digest}, {"status", error ? "failed" : "done"}};
  json["keys"] = keys_json(point.keys);
  json["sets"] = point.sets;
  if (error) json["error"] = {{"kind", error->kind}, {"text", error->text}};
  json["host"] = {{"seconds", seconds}};
  if (!report.is_null()) json["report"] = report;
  // A text of a scene or a signal's name may be no UTF-8: it must not lose the point.
  AtomicFile file(point_path(out, point.digest));  // what killed writers left in the folder is removed for all at once
  file.write(json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n");
  file.commit();
}

std::optional<PointFile> read_point(const std::filesystem::path& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) return std::nullopt;
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  try {
    Json json = Json::parse(text);
    PointFile out;
    out.digest = json.at("point");
    out.keys = json.at("keys");
    out.seconds = json.at("host").at("seconds");
    if (json.at("status") != "done") out.error = PointError{json.at("error").at("kind"), json.at("error").at("text")};
    if (json.contains("report")) out.report = std::move(json["report"]);
    if (out.done() && !out.report.is_object()) throw std::runtime_error("no report");
    if (file.stem() == out.digest) return out;
  } catch (const std::exception&) {
  }
  spdlog::warn("{} is damaged; its point runs again", file.string());
  return std::nullopt;
}

}  // namespace carousel::app
