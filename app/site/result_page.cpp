#include "app/site/result_page.h"

#include <cstdint>
#include <exception>
#include <fstream>
#include <iterator>
#include <optional>
#include <utility>

#include <spdlog/spdlog.h>

#include "core/system/error.h"
#include "report/html/run_page.h"
#include "report/html/studies/study_pages.h"
#include "report/html/studies/sweep_page.h"
#include "shading/camera/page_picture.h"

namespace carousel::app {

using Json = nlohmann::ordered_json;

namespace {

/// What `carousel versus` said of the machine of a run: in its folder, or in the one that versus takes by itself.
std::optional<Json> versus_beside(const Json& report, const std::filesystem::path& folder) {
  const std::filesystem::path full = std::filesystem::absolute(folder / ".").lexically_normal().parent_path();
  for (const std::filesystem::path& path :
       {full / "versus.json", full.parent_path() / (full.filename().string() + "-versus") / "versus.json"}) {
    std::error_code ignored;
    if (!std::filesystem::exists(path, ignored)) continue;
    try {
      report::Document document = report::read_document(path);
      if (document.kind == report::DocumentKind::kVersus && report::html::is_of_run(document.json, report))
        return std::move(document.json);
    } catch (const std::exception& error) {
      spdlog::debug("{}: is not shown beside the run: {}", path.string(), error.what());
    }
  }
  return std::nullopt;
}

/// The rows of all pixels; none where there is no such file.
std::string rows_of_heat(const std::filesystem::path& file) {
  constexpr std::uintmax_t kMostBytes = 64u << 20;
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error) || std::filesystem::file_size(file, error) > kMostBytes) return {};
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

}  // namespace

std::string run_page_of(const Json& report, const std::filesystem::path& folder) {
  report::html::Picture picture;
  report::html::HeatMap heat;
  if (report.contains("digest") && report["digest"].contains("image"))
    if (const auto found = shading::page_picture(folder / "image.png")) picture = {found->mime_type, found->bytes};
  if (report.contains("heat")) {
    if (const auto found = shading::page_picture(folder / "heat_cycles.png"))
      heat.picture = {found->mime_type, found->bytes};
    heat.rows = rows_of_heat(folder / "heat.csv");
  }
  const std::optional<Json> versus = versus_beside(report, folder);
  return report::html::run_page(report, picture, heat, versus ? &*versus : nullptr);
}

std::string page_of_file(const report::Document& document, const std::filesystem::path& file, bool asks) {
  using report::DocumentKind;
  const Json& json = document.json;
  switch (document.kind) {
    case DocumentKind::kRayLife:
      return report::html::ray_life_page(json);
    case DocumentKind::kPoint:
      if (!json.contains("report")) throw FileError(file.string() + ": the point has no report, since its run failed");
      return run_page_of(json["report"], file.parent_path());
    case DocumentKind::kSweep:
      return report::html::sweep_page(json, file.has_parent_path() ? file.parent_path().string() : ".", asks);
    case DocumentKind::kAccuracy:
      return report::html::accuracy_page(json);
    case DocumentKind::kStress:
      return report::html::stress_page(json);
    case DocumentKind::kVersus:
      return report::html::versus_page(json);
    default:
      return run_page_of(json, file.parent_path());
  }
}

std::vector<std::filesystem::path> results_in(const std::filesystem::path& folder) {
  std::vector<std::filesystem::path> out;
  std::error_code ignored;
  for (const char* name : {"sweep.json", "report.json", "accuracy.json", "stress.json", "versus.json"})
    if (std::filesystem::exists(folder / name, ignored)) out.push_back(folder / name);
  return out;
}

}  // namespace carousel::app
