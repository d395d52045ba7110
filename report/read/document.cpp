#include "report/read/document.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <optional>
#include <set>

#include <fmt/format.h>

#include "core/config/load/load.h"
#include "core/config/schema.h"
#include "core/numeric/bytes_digest.h"
#include "core/system/error.h"
#include "core/system/version.h"
#include "report/read/consistency.h"
#include "report/read/schema_check.h"
#include "report/read/strict_json.h"
#include "report/run/report_json.h"
#include "report/schema/document_version.h"

namespace carousel::report {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::uintmax_t kMostBytes = std::uintmax_t{512} << 20;
constexpr const char* kChecksum = "checksum";
constexpr const char* kExpected =
    "expected the report.json of carousel run, a sweep.json or a point of it, a stress.json, an accuracy.json, a "
    "versus.json, or the JSON of carousel follow";

/// Told by its keys.
std::optional<DocumentKind> kind_of(const Json& json) {
  struct Marks {
    const char *first, *second;
    DocumentKind kind;
  };
  constexpr Marks kMarks[] = {
      {"point", "sets", DocumentKind::kPoint},       {"points", "main_effects", DocumentKind::kSweep},
      {"config", "engine", DocumentKind::kRun},      {"levels", "spawn", DocumentKind::kAccuracy},
      {"rows", "cores", DocumentKind::kStress},      {"spans", "stages", DocumentKind::kRayLife},
      {"machines", "against", DocumentKind::kVersus}};
  if (!json.is_object()) return std::nullopt;
  for (const Marks& marks : kMarks)
    if (json.contains(marks.first) && json.contains(marks.second)) return marks.kind;
  return std::nullopt;
}

const Json& schema_of(DocumentKind kind) {
  static const Json kSchema = report_schema();
  static const Json kRun = [] {
    Json run = kSchema;
    run.erase("$defs");
    return run;
  }();
  switch (kind) {
    case DocumentKind::kSweep:
      return kSchema["$defs"]["sweep"];
    case DocumentKind::kPoint:
      return kSchema["$defs"]["point"];
    case DocumentKind::kStress:
      return kSchema["$defs"]["stress"];
    case DocumentKind::kAccuracy:
      return kSchema["$defs"]["accuracy"];
    case DocumentKind::kRayLife:
      return kSchema["$defs"]["ray_life"];
    case DocumentKind::kVersus:
      return kSchema["$defs"]["versus"];
    default:
      return kRun;
  }
}

/// The digest of all but `host`: two runs that are identical have the same digest.
std::string digest_of(Json json) {
  json.erase("host");
  return bytes_digest(json.dump(-1, ' ', false, Json::error_handler_t::replace));
}

void require_version(const Json& json) {
  const auto version = json.find("schema_version");
  if (version != json.end() && version->is_number_integer() && *version != kDocumentVersion)
    throw JsonFault("schema_version",
                    fmt::format("this program reads version {}, found {}", kDocumentVersion, version->dump()));
}

/// A fault of a report that stands in another document has a longer path.
template <class Required>
void require_below(const std::string& path, const Required& required) {
  try {
    required();
  } catch (const JsonFault& fault) {
    throw JsonFault(fault.path().empty() ? path : path + "." + fault.path(), fault.message());
  }
}

/// The configuration of a report without what its plugins have brought, which the report lists. No report makes the
/// program open a plugin: it may come from a stranger, and the plugin need not be there any more.
Json without_plugins(const Json& report) {
  Json config = report["config"];
  const Json::json_pointer plugins("/engine/plugins"), workload("/workload/plugin");
  if (!config.contains(plugins) || config[plugins].empty()) return config;
  config["engine"].erase("plugins");
  if (config.contains(workload)) config.erase("workload");
  std::set<std::string> names;
  for (const Json& plugin : report.value("plugins", Json::array()))
    for (const Json& brought : plugin["brings"]) {
      const std::string text = brought.get<std::string>();
      names.insert(text.substr(text.rfind(' ') + 1));
    }
  for (const std::string& key : config::config_key_paths()) {
    const std::size_t dot = key.rfind('.');
    if (dot == key.npos || config::enum_values(key).empty()) continue;
    std::string section = "/" + key.substr(0, dot);
    std::replace(section.begin(), section.end(), '.', '/');
    const Json::json_pointer at(section);
    const std::string name = key.substr(dot + 1);
    if (!config.contains(at) || !config[at].is_object() || !config[at].contains(name)) continue;
    if (const Json& value = config[at][name]; value.is_string() && names.contains(value.get<std::string>()))
      config[at].erase(name);
  }
  return config;
}

void require_configuration(const Json& report) {
  try {
    load_config({without_plugins(report).dump(), "config.json"}, {}, {.fields_only = true});
  } catch (const ConfigError& error) {
    const ConfigIssue& issue = error.issues().front();
    throw JsonFault(path_below("config", issue.key_path), issue.message);
  }
}

void require_run(const Json& report) {
  require_version(report);
  require_schema(schema_of(DocumentKind::kRun), report);
  require_configuration(report);
  require_consistent_run(report);
}

void require_document(DocumentKind kind, const Json& json) {
  require_version(json);
  if (kind == DocumentKind::kRun) return require_run(json);
  require_schema(schema_of(kind), json);
  if (kind == DocumentKind::kSweep) require_consistent_sweep(json);
  if (kind == DocumentKind::kPoint && json.contains("report"))
    require_below("report", [&] { require_run(json["report"]); });
}

/// Takes the checksum away. A document without one is of a program that wrote none, or was changed on purpose.
void require_checksum(DocumentKind kind, Json& json) {
  const auto found = json.find(kChecksum);
  if (found == json.end()) {
    if (kind == DocumentKind::kPoint) throw JsonFault(kChecksum, "expected the digest of the content, found nothing");
    return;
  }
  const std::string told = found->get<std::string>();
  json.erase(kChecksum);
  if (const std::string digest = digest_of(json); told != digest)
    throw JsonFault(kChecksum,
                    fmt::format("expected {}, the digest of the content, found {}; the file was changed or damaged "
                                "after it was written (one that was changed on purpose is read without this key)",
                                digest, found_text(told)));
}

/// The program that wrote a document whose shape is another one.
std::string writer_of(const Json& json) {
  const Json::json_pointer version("/carousel/version"), commit("/carousel/commit");
  if (!json.is_object() || !json.contains(version) || !json.contains(commit)) return "";
  const Json &a = json[version], &b = json[commit];
  const BuildInfo own = build_info();
  if (!a.is_string() || !b.is_string() || (a == own.version && b == own.commit)) return "";
  return fmt::format(" (written by Carousel {}, commit {}; this is {}, commit '{}')", found_text(a), found_text(b),
                     own.version, own.commit);
}

}  // namespace

Json sealed(Json document) {
  document.erase(kChecksum);
  std::string digest = digest_of(document);
  document[kChecksum] = std::move(digest);
  return document;
}

Document parse_document(std::string_view text, const std::string& name) {
  Document out;
  try {
    out.json = strict_json(text);
  } catch (const JsonFault& fault) {
    throw FileError(name + ": " + fault.what() + "; " + kExpected);
  }
  const std::optional<DocumentKind> kind = kind_of(out.json);
  if (!kind) throw FileError(name + ": " + kExpected);
  out.kind = *kind;
  try {
    require_document(out.kind, out.json);
    require_checksum(out.kind, out.json);
  } catch (const JsonFault& fault) {
    throw FileError(name + ": " + fault.what() + writer_of(out.json));
  }
  return out;
}

Document read_document(const std::filesystem::path& file) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(file, error);
  if (std::filesystem::is_directory(status)) throw FileError(file.string() + ": expected a file, found a folder");
  errno = 0;
  std::ifstream in(file, std::ios::binary);
  if (!in) throw FileError(file.string() + ": cannot be read: " + std::strerror(errno));
  // Not by the size of the file, which a pipe or a device does not tell.
  std::string text;
  for (char block[1 << 16]; in.read(block, sizeof block), in.gcount() > 0;) {
    text.append(block, static_cast<std::size_t>(in.gcount()));
    if (text.size() > kMostBytes) throw FileError(file.string() + ": expected at most 512 MiB");
  }
  if (in.bad()) throw FileError(file.string() + ": cannot be read");
  return parse_document(text, file.string());
}

}  // namespace carousel::report
