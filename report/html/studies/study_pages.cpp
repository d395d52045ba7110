#include "report/html/studies/study_pages.h"

#include <algorithm>
#include <functional>
#include <vector>

#include <fmt/format.h>

#include "report/html/html.h"
#include "report/html/page.h"
#include "report/html/still.h"
#include "report/text/singular.h"

namespace carousel::report::html {

namespace {

/// Numbers and texts of an object and those inside it, by their paths.
void flatten(const Json& object, const std::string& path, std::vector<std::pair<std::string, Json>>& out) {
  for (const auto& [key, value] : object.items()) {
    const std::string name = path.empty() ? key : path + "." + key;
    if (value.is_object())
      flatten(value, name, out);
    else if (!value.is_array())
      out.emplace_back(name, value);
  }
}

/// A row for each object of a list: its name, then the columns `first`, then all others in their order.
Table table_of_rows(std::string id, std::string caption, const Json& list,
                    const std::function<std::string(const Json&)>& name, const std::vector<std::string>& first) {
  Table table{std::move(id), std::move(caption), {{"name"}}};
  std::vector<std::string> keys = first;
  for (const Json& row : list) {
    std::vector<std::pair<std::string, Json>> values;
    flatten(row, "", values);
    for (const auto& [key, value] : values)
      if (std::find(keys.begin(), keys.end(), key) == keys.end()) keys.push_back(key);
  }
  for (const std::string& key : keys) {
    std::string title = words(key);
    std::replace(title.begin(), title.end(), '.', ' ');
    table.columns.push_back({title});
  }
  for (const Json& row : list) {
    auto& cells = table.rows.emplace_back();
    cells.push_back(cell(name(row)));
    for (const std::string& key : keys) {
      const Json* value = find(row, key);
      cells.push_back(value && !value->is_null() ? cell(*value) : cell("–"));
    }
  }
  return table;
}

/// The first column of numbers after the name; 0 if there is none.
std::size_t first_number(const Table& table) {
  for (std::size_t c = 1; c < table.columns.size(); ++c)
    if (table.rows[0][c].number.is_number()) return c;
  return 0;
}

Html bars_of(const Table& table, const std::string& title) {
  if (table.rows.empty()) return {};
  return Figure{.id = "fig-" + table.id,
                .kind = "bars",
                .tables = table.id,
                .title = title,
                .label = "Bars, a bar a row of the table below.",
                .height = 90 + 26 * static_cast<int>(std::min<std::size_t>(table.rows.size(), 24)),
                .still = first_number(table) ? still_bars(table, first_number(table)) : Html()}
             .html() +
         table.html();
}

/// The levels to choose, of accuracy.json; nothing where none is safe.
std::string advice_words(const Json& accuracy) {
  const auto levels = [&](const char* clock) {
    const Json* found = find(accuracy, fmt::format("recommended.{}", clock));
    return !found || !found->is_object()
               ? std::string()
               : fmt::format("{} + {} + {}", words(text_at(*found, "triangle")), words(text_at(*found, "box")),
                             words(text_at(*found, "transform")));
  };
  const std::string host = levels("host"), machine = levels("hardware");
  if (host.empty() && machine.empty()) return {};
  if (host == machine) return fmt::format("Safe for the least cost: {}.", host);
  std::string out = host.empty() ? "" : fmt::format("Safe for the least cost on this host: {}.", host);
  if (!machine.empty())
    out += fmt::format("{}{}: {}.", out.empty() ? "Safe for the least cost " : " ",
                       out.empty() ? "in hardware" : "In hardware", machine);
  return out;
}

/// A verdict of several sentences: the first is the headline, unless there is one, the others a line each.
Html sentences_of(std::string text, bool headline = true) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  Html out;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t point = text.find(". ", begin), end = point == text.npos ? text.size() : point + 1;
    const std::string sentence = text.substr(begin, end - begin);
    out += begin == 0 && headline ? markup("<p class=\"verdict\">{}</p>\n", sentence) : markup("<p>{}</p>\n", sentence);
    begin = end + 1;
  }
  return out;
}

Html interrupted(const Json& report) {
  return report.value("incomplete", false)
             ? markup("<p class=\"notice\"><strong>Incomplete:</strong> it was interrupted.</p>\n")
             : Html();
}

}  // namespace

std::string stress_page(const Json& stress) {
  const auto text = [](const Json& row, const char* key) { return words(text_at(row, key)); };
  const Table rows = table_of_rows("queues", "Queues by themselves, messages a second", stress["rows"],
                                   [&](const Json& row) {
                                     return fmt::format("{}, {}, {} bytes", text(row, "queue"), text(row, "pattern"),
                                                        number_at(row, "message_bytes"));
                                   },
                                   {"rate_median", "rate_least", "rate_most"});
  const Table ring = table_of_rows(
      "ring", "Queues in the links of the configuration's machine, rays a second",
      stress.contains("ring") ? stress["ring"] : Json::array(),
      [&](const Json& row) { return fmt::format("{} of depth {}", text(row, "queue"), number_at(row, "depth")); },
      {"rate_median", "rate_least", "rate_most"});
  std::uint64_t faulty = 0;
  std::string which;
  for (std::size_t i = 0; i < rows.rows.size(); ++i)
    if (const std::string found = text_at(stress["rows"][i], "found"); !found.empty() && ++faulty <= 6)
      which += fmt::format("{}{} ({})", which.empty() ? "" : "; ", rows.rows[i][0].text, found);
  if (faulty > 6) which += fmt::format("; and {} more", faulty - 6);
  Html glance = interrupted(stress);
  glance += markup("<p class=\"verdict\">{}</p>\n", faulty == 0 ? "No queue lost, doubled, reordered or tore a message."
                                                                : fmt::format("Faults of queues: {}.", which));
  if (const std::string verdict = text_at(stress, "ring_verdict"); !verdict.empty())
    glance += markup("<p>{}</p>\n", verdict);
  glance +=
      markup("<p>{}</p>\n",
             singular(fmt::format("{} repetitions on a host of {} hardware threads. Rates of queues are the host's.",
                                  number_at(stress, "repetitions"), number_at(stress, "cores"))));
  return page_of("Carousel: stress of queues", "carousel stress",
                 {{"verdict", "At a glance", glance},
                  {"alone", "Queues by themselves", bars_of(rows, rows.caption)},
                  {"inside", "Queues in the machine", bars_of(ring, ring.caption)}},
                 Json::object(), {});
}

std::string versus_page(const Json& versus) {
  const auto name = [](const char* key) { return [key](const Json& row) { return words(text_at(row, key)); }; };
  const Table machines = table_of_rows("machines", "The machines", versus["machines"], name("name"),
                                       {"rays_per_kilocycle.mean", "rays_per_kilocycle.error"});
  const Table against = table_of_rows("against", "This machine against each twin", versus["against"], name("than"),
                                      {"speed.ratio", "speed.low", "speed.high"});
  const Table turns = table_of_rows("turns", "The slower machine with one class of parts relaxed", versus["turns"],
                                    [](const Json& row) { return text_at(row, "action"); }, {"speed", "gain"});
  const Table runs =
      table_of_rows("runs", "Every simulated frame", versus["runs"],
                    [](const Json& row) {
                      return fmt::format("{}, seed {}", words(text_at(row, "machine")), number_at(row, "seed"));
                    },
                    {"rays_per_kilocycle"});
  Html splits;
  for (const char* const search : {"search", "twin_search"})
    if (const Json* trials = find(versus, std::string(search) + ".trials"))
      splits += table_of_rows(
                    search, search == std::string("search") ? "Of this machine" : "Of the twin at equal area", *trials,
                    [](const Json& row) { return singular(fmt::format("{} resources", row["resources"].get<int>())); },
                    {"cycles", "nj_per_ray", "mm2"})
                    .html();
  Html glance;
  for (std::size_t i = 0; i < versus["lines"].size(); ++i)
    glance += markup("<p class=\"{}\">{}</p>\n", i == 0 ? "verdict" : "detail",
                     capital(versus["lines"][i].get<std::string>()));
  Html twin = markup("<p>The twin is this machine with these keys:</p>\n<ul>\n");
  for (const Json& set : versus["twin_sets"]) twin += markup("<li><code>{}</code></li>\n", set.get<std::string>());
  twin += markup("</ul>\n");
  if (versus.contains("drawing")) twin += markup("<p>Of the drawing: {}.</p>\n", versus["drawing"].get<std::string>());
  return page_of("Carousel: a machine against its conventional twin", "carousel versus",
                 {{"verdict", "At a glance", glance},
                  {"machines", "The machines", bars_of(machines, "Rays per kilocycle")},
                  {"against", "Against each twin", against.html()},
                  {"turns", "What would turn it round", bars_of(turns, "Speed over that of the faster machine")},
                  {"splits", "Splits of the area that were simulated", splits},
                  {"runs", "Runs", runs.html()},
                  {"twin", "The twin", twin}},
                 Json::object(), {});
}

std::string accuracy_page(const Json& accuracy) {
  Json levels = accuracy["levels"];
  for (Json& row : levels) {
    double wrong = number_at(row, "scene.missed") + number_at(row, "scene.extra");
    if (row.contains("hard"))
      for (const Json& hard : row["hard"]) wrong += number_at(hard, "missed") + number_at(hard, "extra");
    row["wrong_answers"] = static_cast<std::uint64_t>(wrong);
  }
  const auto name = [](const Json& row) {
    return fmt::format("{} / {} / {}", text_at(row, "triangle"), text_at(row, "box"), text_at(row, "transform"));
  };
  const Table table =
      table_of_rows("levels", "Levels of accuracy: triangle / box / transform", levels, name,
                    {"ns_per_ray.median", "wrong_answers", "ns_per_ray.least", "ns_per_ray.most", "frontier.host"});
  const Table spawn = table_of_rows("spawn", "Offset of new rays", accuracy["spawn"],
                                    [](const Json& row) { return text_at(row, "spawn"); }, {});
  const Table sampling = table_of_rows(
      "sampling", "Error of the picture over the number of samples", accuracy["sampling"]["rows"],
      [](const Json& row) { return singular(fmt::format("{} samples", number_at(row, "samples"))); }, {"rmse"});
  Html glance = interrupted(accuracy);
  if (const std::string advice = advice_words(accuracy); !advice.empty())
    glance += markup("<p class=\"verdict\">{}</p>\n", advice);
  glance += sentences_of(text_at(accuracy, "verdict"), glance.empty());
  glance += markup("<p>{}</p>\n",
                   singular(fmt::format(
                       "{} rays of the scene {} were compared with exact arithmetic, each measured {} times.",
                       value_text(accuracy["rays"]), text_at(accuracy, "scene"), number_at(accuracy, "repetitions"))));
  Html body = Figure{.id = "fig-levels",
                     .kind = "scatter",
                     .tables = "levels",
                     .title = "Wrong answers against time a ray on the host",
                     .label =
                         "Scatter plot of the levels: time a ray against wrong answers. The table below "
                         "has the numbers.",
                     .height = 420}
                  .html() +
              table.html();
  Table hardware = table_of_rows("levels-on-hardware", "Levels of accuracy on a machine that its testers limit", levels,
                                 name, {"tester_limited_cycles_per_ray", "wrong_answers", "unit_area_over_default"});
  hardware.columns.resize(4);
  for (auto& row : hardware.rows) row.resize(4);
  if (!hardware.rows.empty() && !hardware.rows.front()[1].number.is_null())
    body += Figure{.id = "fig-levels-on-hardware",
                   .kind = "scatter",
                   .tables = hardware.id,
                   .title = "Wrong answers against cycles a ray in hardware",
                   .label = "Scatter plot of the levels: cycles a ray where the testers limit against wrong answers.",
                   .height = 420}
                .html() +
            hardware.html();
  return page_of("Carousel: levels of accuracy", "carousel accuracy, scene " + text_at(accuracy, "scene"),
                 {{"verdict", "At a glance", glance},
                  {"levels", "Time and errors of the levels", body},
                  {"spawn", "Where new rays start", spawn.html()},
                  {"sampling", "Samples", bars_of(sampling, sampling.caption)}},
                 Json::object(), {});
}

std::string ray_life_page(const Json& life) {
  const std::string unit = text_at(life, "unit");
  const auto list = [&](const char* key) { return life.contains(key) ? life[key] : Json::array(); };
  const Table stages = table_of_rows("stages", "Time by stage", list("stages"),
                                     [](const Json& row) { return text_at(row, "stage"); }, {"length", "share"});
  const Json rows = list("spans");
  std::size_t number = 0;
  const Table spans =
      table_of_rows("spans", "Stretches of its time", rows, [&](const Json&) { return std::to_string(++number); }, {});
  number = 0;
  const Table tests =
      table_of_rows("tests", "Tests", list("tests"), [&](const Json&) { return std::to_string(++number); }, {});
  const Table caused = table_of_rows("caused", "Rays that came of it", list("caused"),
                                     [](const Json& row) { return text_at(row, "kind"); }, {});
  Html glance =
      markup("<p class=\"verdict\">The ray took {} {}{}.</p>\n", value_text(life.value("latency", Json(0))), unit,
             stages.rows.empty() ? "" : fmt::format(", most of it in the stage: {}", stages.rows.front().front().text));
  glance += values_of("ray", "The ray", life, Json::object()).html();
  Html where = Figure{.id = "fig-spans",
                      .kind = "spans",
                      .tables = "spans",
                      .title = "Its time, stage by stage",
                      .label = "Bars over time, a line a stage; the table below has each stretch.",
                      .height = 320}
                   .html();
  return page_of("Carousel: the life of a ray", "carousel follow, " + text_at(life, "engine") + " engine",
                 {{"verdict", "At a glance", glance},
                  {"where", "Use of its time", bars_of(stages, stages.caption)},
                  {"stretches", "Its time in order", spans.rows.empty() ? Html() : where + spans.html()},
                  {"tested", "Tests of the ray", tests.html()},
                  {"next", "Rays it caused", caused.html()}},
                 Json::object(), {});
}

}  // namespace carousel::report::html
