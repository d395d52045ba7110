#include "report/html/page.h"

#include <fmt/format.h>

#include "report/html/bundle.h"
#include "report/html/html.h"

namespace carousel::report::html {

namespace {

constexpr const char* kNoCharts =
    "<p class=\"notice\">This page has no charts, because the program that wrote it was built without npm's packages. "
    "Every number stands in the tables. To get the charts, install npm, run <code>script/bootstrap</code>, build "
    "again, "
    "and run <code>carousel report DIR</code> on this folder.</p>\n";
constexpr const char* kNoScripts =
    "<noscript><p class=\"notice\">Charts need scripts, which this browser does not run. Every number of the charts "
    "stands in the tables.</p></noscript>\n";

}  // namespace

std::string page_of(const std::string& title, const std::string& subtitle, const std::vector<Section>& sections,
                    const Json& facts, const std::string& data) {
  const std::string_view script = script_bundle();
  std::string out = fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta name=\"color-scheme\" content=\"light dark\">\n<link rel=\"icon\" href=\"data:,\">\n"
      "<title>{}</title>\n<style>\n{}</style>\n</head>\n<body>\n<a class=\"skip\" href=\"#content\">Skip to the "
      "report</a>\n<header><h1>{}</h1>\n<p>{}</p>\n<nav aria-label=\"Sections\"><ul>\n",
      escaped(title), style_sheet(), escaped(title), escaped(subtitle));
  for (const Section& section : sections)
    if (!section.body.empty())
      out += fmt::format("<li><a href=\"#{}\">{}</a></li>\n", section.id, escaped(section.title));
  out += "</ul></nav></header>\n<main id=\"content\" tabindex=\"-1\">\n";
  out += script.empty() ? kNoCharts : kNoScripts;
  for (const Section& section : sections)
    if (!section.body.empty())
      out += fmt::format(
          "<section id=\"{0}\" aria-labelledby=\"{0}-title\"><h2 id=\"{0}-title\">{1}</h2>\n{2}</section>\n",
          section.id, escaped(section.title), section.body);
  out += "</main>\n<footer><p>Written by Carousel. The page needs no network.</p></footer>\n";
  if (!script.empty()) {
    std::string json = facts.dump();
    for (std::size_t at = 0; (at = json.find('<', at)) != std::string::npos; at += 6) json.replace(at, 1, "\\u003c");
    out += fmt::format("<script type=\"application/json\" id=\"facts\">{}</script>\n{}<script>{}</script>\n", json,
                       data, script);
  }
  return out + "</body>\n</html>\n";
}

}  // namespace carousel::report::html
