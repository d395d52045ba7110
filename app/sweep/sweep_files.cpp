#include "app/sweep/sweep_files.h"

#include "app/host/program_info.h"
#include "report/schema/document_version.h"

namespace carousel::app {

using Json = nlohmann::ordered_json;

namespace {

std::string field(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == text.npos) return text;
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

std::string cell(const Json& value) {
  if (value.is_null()) return "";
  return field(value.is_string() ? value.get<std::string>() : value.dump());
}

const char* status(const SweepRow& row) {
  return !row.finished ? "missing" : row.error ? "failed" : "done";
}

Json effect_json(const MainEffect& effect) {
  Json levels = Json::array();
  for (const LevelEffect& level : effect.levels) {
    Json one{{"level", value_json(level.level)}, {"points", level.points}, {"effect", level.effect}};
    if (level.half_width) {
      one["low"] = level.effect - *level.half_width;
      one["high"] = level.effect + *level.half_width;
    }
    levels.push_back(std::move(one));
  }
  return {{"key", effect.key}, {"result", effect.result}, {"mean", effect.mean}, {"levels", std::move(levels)}};
}

}  // namespace

std::string sweep_csv(const SweepRows& rows) {
  std::string out = "point,status";
  for (const std::string& key : rows.keys) out += "," + field(key);
  for (const ResultColumn& column : rows.columns) out += "," + field(column.name);
  out += ",error\r\n";
  for (const SweepRow& row : rows.rows) {
    out += row.point.digest + "," + status(row);
    for (const KeyValue& key : row.point.keys) out += "," + field(key.second);
    for (std::size_t i = 0; i < rows.columns.size(); ++i)
      out += "," + (i < row.results.size() ? cell(row.results[i]) : "");
    out += "," + (row.error ? field(row.error->kind + ": " + row.error->text) : "") + "\r\n";
  }
  return out;
}

Json row_json(const SweepRows& rows, const SweepRow& row) {
  Json out{{"point", row.point.digest}, {"status", status(row)}, {"keys", keys_json(row.point.keys)}};
  Json& results = out["results"] = Json::object();
  for (std::size_t i = 0; i < row.results.size(); ++i) results[rows.columns[i].name] = row.results[i];
  if (row.error) out["error"] = {{"kind", row.error->kind}, {"text", row.error->text}};
  out["host_seconds"] = row.seconds;
  return out;
}

Json sweep_json(const SweepRows& rows, const std::vector<Goal>& goals, const std::string& config) {
  const report::Program program = program_info();
  Json out{{"schema_version", report::kDocumentVersion},
           {"carousel", {{"version", program.version}, {"commit", program.commit}}},
           {"config", config},
           {"keys", rows.keys}};
  Json& names = out["results"] = Json::array();
  for (const ResultColumn& column : rows.columns) names.push_back(column.name);
  Json& greater = out["greater_is_better"] = Json::array();
  for (const ResultColumn& column : rows.columns)
    if (column.greater_is_better) greater.push_back(column.name);
  Json& points = out["points"] = Json::array();
  for (const SweepRow& row : rows.rows) points.push_back(row_json(rows, row));
  if (!goals.empty()) {
    Json& pareto = out["pareto"] = {{"goals", Json::array()}, {"points", Json::array()}};
    for (const Goal& goal : goals)
      pareto["goals"].push_back({{"result", rows.columns[goal.column].name}, {"maximise", goal.maximise}});
    for (const std::size_t row : pareto_front(rows, goals)) pareto["points"].push_back(rows.rows[row].point.digest);
  }
  Json& effects = out["main_effects"] = Json::array();
  for (std::size_t i = 0; i < rows.columns.size(); ++i)
    for (const MainEffect& effect : main_effects(rows, i)) effects.push_back(effect_json(effect));
  return out;
}

}  // namespace carousel::app
