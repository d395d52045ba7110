#include <fmt/format.h>

#include "report/html/html.h"
#include "report/html/run_sections.h"
#include "report/text/number_text.h"
#include "report/text/singular.h"

namespace carousel::report::html {

namespace {

Figure frame_bars(const Table& table, const char* kind, const std::string& label) {
  return {.id = "fig-" + table.id,
          .kind = kind,
          .tables = table.id,
          .title = table.caption,
          .label = label,
          .height = bars_height(table),
          .still = still_bars(table, 1)};
}

std::string in_words(const Json& frames) {
  std::string out = fmt::format("{} frames, {} rays", value_text(frames["count"]), value_text(frames["rays"]));
  if (find(frames, "cycles"))
    out += fmt::format(", {} cycles, {} of them the builder's", value_text(frames["cycles"]),
                       percent(number_at(frames, "builder_cycles") / number_at(frames, "cycles", 1)));
  return singular(out) + ". All other sections are those of the last frame.";
}

/// Frames in which the update or the wear of the tree decides, if there are any.
std::string remarkable(const Json& frames) {
  std::string out;
  if (const double limited = number_at(frames, "limited_by_builder"); limited > 0)
    out += singular(fmt::format("In {:.0f} frames the update takes longer than the rays. ", limited));
  if (const double worn = number_at(frames, "worn"); worn > 0)
    out += singular(fmt::format("In {:.0f} frames the refitted tree is so worn that a rebuild pays.", worn));
  return out;
}

}  // namespace

Html frames_section(const Json& report, const Json& schema) {
  const Json* frames = find(report, "frames");
  if (!frames) return {};
  const Json& rows = (*frames)["rows"];
  Html out = markup("<p>{}</p>\n", in_words(*frames));
  if (const std::string text = remarkable(*frames); !text.empty()) out += markup("<p>{}</p>\n", text);
  Table cycles{"frame-cycles", "Cycles by frame", {{"frame"}, {"rays", "cycles"}, {"update before them", "cycles"}}},
      tests{"frame-tests", "Tests of boxes and primitives by frame", {{"frame"}, {"tests"}}};
  for (const Json& row : rows) {
    const std::string name = value_text(row["frame"]);
    if (row.contains("cycles"))
      cycles.rows.push_back(
          {cell(name), cell(row["cycles"]), cell(Json(static_cast<std::uint64_t>(number_at(row, "builder.cycles"))))});
    tests.rows.push_back({cell(name), cell(Json(static_cast<std::uint64_t>(number_at(row, "box_tests") +
                                                                           number_at(row, "primitive_tests"))))});
  }
  if (!cycles.rows.empty())
    out += frame_bars(cycles, "groups", "Two bars a frame: the cycles of its rays, and of the update before them.")
               .html() +
           cycles.html();
  out += frame_bars(tests, "bars", "A bar a frame: the tests of its rays.").html() + tests.html();
  const Json& of_row = schema_at(schema, "properties.frames.properties.rows.items");
  return out + table_of("frames", "The frames", rows, of_row).html();
}

}  // namespace carousel::report::html
