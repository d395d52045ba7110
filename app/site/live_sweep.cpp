#include "app/site/live_sweep.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "app/sweep/process/point_file.h"
#include "app/sweep/results.h"
#include "report/html/html.h"
#include "report/html/page.h"

namespace carousel::app {

namespace fs = std::filesystem;
using namespace report::html;

namespace {

constexpr std::size_t kMostRows = 200;

struct Finished {
  fs::file_time_type time;
  fs::path file;
};

/// The files of finished points, the newest first.
std::vector<Finished> finished_points(const fs::path& folder) {
  std::vector<Finished> out;
  std::error_code error;
  for (auto at = fs::directory_iterator(folder / "points", error); !error && at != fs::directory_iterator();
       at.increment(error)) {
    std::error_code ignored;
    if (at->path().extension() == ".json" && at->is_regular_file(ignored))
      out.push_back({fs::last_write_time(at->path(), ignored), at->path()});
  }
  std::sort(out.begin(), out.end(), [](const Finished& a, const Finished& b) { return a.time > b.time; });
  return out;
}

}  // namespace

bool is_sweep(const fs::path& folder) {
  std::error_code ignored;
  return fs::is_directory(folder / "points", ignored);
}

std::string live_sweep_page(const fs::path& folder) {
  const std::vector<Finished> points = finished_points(folder);
  Table table{
      "points", "Finished points, the newest first", {{"point"}, {"keys"}, {"cycles"}, {"limits"}, {"time", "s"}}};
  table.open = true;
  const std::vector<ResultColumn> columns = result_columns({});
  const auto result = [&](const char* name, const Json& report) -> Json {
    for (const ResultColumn& column : columns)
      if (column.name == name) return report.is_object() ? result_of(column, report) : Json();
    return nullptr;
  };
  std::size_t failed = 0;
  for (const Finished& point : points) {
    if (table.rows.size() == kMostRows) break;
    const std::optional<PointFile> file = read_point(point.file);
    if (!file) continue;
    failed += file->done() ? 0 : 1;
    std::string keys;
    for (const auto& [key, value] : file->keys.items())
      keys += (keys.empty() ? "" : ", ") + key + " = " + (value.is_string() ? value.get<std::string>() : value.dump());
    const Json cycles = result("cycles", file->report), limits = result("limits", file->report);
    table.rows.push_back({cell(file->digest), cell(keys),
                          cycles.is_number() ? cell(cycles) : cell(file->error ? file->error->kind : "–"),
                          cell(limits.is_string() ? words(limits.get<std::string>()) : "–"),
                          cell(Json(file->seconds))});
  }
  Html body = markup(
      "<p class=\"verdict\">{} {} finished so far{}.</p>\n<p>The sweep is running, or was interrupted. This "
      "page loads itself again every three seconds; its charts come with the last point.</p>\n",
      points.size(), points.size() == 1 ? "point is" : "points are",
      failed > 0 ? fmt::format(", {} of the newest failed", failed) : "");
  std::string html = page_of("Carousel: a sweep under way", folder.filename().string(),
                             {{"glance", "At a glance", body + table.html()}}, Json::object(), {});
  const std::string mark = "<meta charset=\"utf-8\">\n";
  return html.insert(html.find(mark) + mark.size(), "<meta http-equiv=\"refresh\" content=\"3\">\n");
}

}  // namespace carousel::app
