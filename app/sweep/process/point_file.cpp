#include "app/sweep/process/point_file.h"

#include <spdlog/spdlog.h>

#include "core/system/atomic_file.h"
#include "core/system/error.h"
#include "report/read/document.h"
#include "report/schema/document_version.h"

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
  Json json{
      {"schema_version", report::kDocumentVersion}, {"point", point.digest}, {"status", error ? "failed" : "done"}};
  json["keys"] = keys_json(point.keys);
  json["sets"] = point.sets;
  if (error) json["error"] = {{"kind", error->kind}, {"text", error->text}};
  json["host"] = {{"seconds", seconds}};
  if (!report.is_null()) json["report"] = report;
  // A text of a scene or a signal's name may be no UTF-8: it must not lose the point.
  // Files that killed writers left in the folder are removed for all points at once.
  AtomicFile file(point_path(out, point.digest));
  file.write(report::sealed(json).dump(-1, ' ', false, Json::error_handler_t::replace) + "\n");
  file.commit();
}

std::optional<PointFile> read_point(const std::filesystem::path& file) {
  if (std::error_code ignored; !std::filesystem::exists(file, ignored)) return std::nullopt;
  try {
    report::Document document = report::read_document(file);
    const auto fail = [&](const char* expected) { throw FileError(file.string() + ": expected " + expected); };
    Json& json = document.json;
    if (document.kind != report::DocumentKind::kPoint) fail("the point of a sweep");
    PointFile out;
    out.digest = json["point"];
    out.keys = json["keys"];
    out.seconds = json["host"]["seconds"];
    if (json["status"] != "done") {
      if (!json.contains("error")) fail("the error of a point that failed");
      out.error = PointError{json["error"]["kind"], json["error"]["text"]};
    }
    if (json.contains("report")) out.report = std::move(json["report"]);
    if (out.done() && !out.report.is_object()) fail("the report of a point that is done");
    if (file.stem() != out.digest) fail("the point that the file is named after");
    return out;
  } catch (const FileError& error) {
    spdlog::warn("{}; its point runs again", error.what());
  }
  return std::nullopt;
}

}  // namespace carousel::app
