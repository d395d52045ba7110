#include "report/html/page.h"

#include <algorithm>

#include <fmt/format.h>

#include "core/numeric/sha256.h"
#include "report/html/bundle.h"
#include "report/html/html.h"
#include "report/html/packed_series.h"

namespace carousel::report::html {

namespace {

Html no_charts() {
  return markup(
      "<p class=\"notice\">This page has no charts, because the program that wrote it was built without npm's "
      "packages. "
      "Every number stands in the tables. To get the charts, install npm, run <code>script/bootstrap</code>, build "
      "again, and run <code>carousel report DIR</code> on this folder.</p>\n");
}

Html no_scripts() {
  return markup(
      "<noscript><p class=\"notice\">Some charts need scripts, which this browser does not run. Every number of them "
      "stands in the tables.</p></noscript>\n");
}

std::string source_of(std::string_view text) {
  const auto digest = sha256(text);
  return "'sha256-" + base64({reinterpret_cast<const char*>(digest.data()), digest.size()}) + "'";
}

/// The navigation: a link for each tab, to the first of its sections, and for each section that stands outside of tabs.
Html links_of(const std::vector<Section>& sections) {
  Html out;
  std::vector<std::string> tabs;
  const bool tabbed = std::any_of(sections.begin(), sections.end(), [](const Section& s) { return !s.tab.empty(); });
  for (const Section& section : sections) {
    if (section.body.empty() || std::find(tabs.begin(), tabs.end(), section.tab) != tabs.end()) continue;
    if (section.tab.empty()) {
      if (!tabbed) out += markup("<li><a href=\"#{}\">{}</a></li>\n", section.id, section.title);
      continue;
    }
    tabs.push_back(section.tab);
    out += markup("<li><a href=\"#{}\" data-tab=\"{}\">{}</a></li>\n", section.id, section.tab, section.tab);
  }
  return out;
}

/// Charts set style attributes of their own elements, which a hash cannot name.
std::string policy(std::string_view style, std::string_view script, bool asks) {
  return fmt::format(
      "default-src 'none'; script-src {}; style-src-elem {}; style-src-attr 'unsafe-inline'; img-src data:; "
      "{}base-uri 'none'; form-action 'none'",
      script.empty() ? "'none'" : source_of(script), source_of(style), asks ? "connect-src 'self'; " : "");
}

}  // namespace

std::string page_of(const std::string& title, const std::string& subtitle, const std::vector<Section>& sections,
                    const Json& facts, const Html& data, bool asks) {
  const std::string_view script = script_bundle();
  const std::string style = "\n" + std::string(style_sheet());
  static const std::string kPolicies[] = {policy(style, script, false), policy(style, script, true)};
  Html head = markup(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta http-equiv=\"Content-Security-Policy\" content=\"{}\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
      "<meta name=\"color-scheme\" content=\"light dark\">\n<link rel=\"icon\" href=\"data:,\">\n"
      "<title>{}</title>\n",
      kPolicies[asks ? 1 : 0], title);
  Html body = markup(
      "</head>\n<body>\n<a class=\"skip\" href=\"#content\">Skip to the "
      "report</a>\n<header><h1>{}</h1>\n<p>{}</p>\n<nav aria-label=\"Sections\"><ul>\n",
      title, subtitle);
  body += links_of(sections);
  body += markup("</ul></nav></header>\n<main id=\"content\" tabindex=\"-1\">\n");
  body += script.empty() ? no_charts() : no_scripts();
  for (const Section& section : sections)
    if (!section.body.empty())
      body += markup(
          "<section id=\"{0}\" data-tab=\"{3}\" aria-labelledby=\"{0}-title\"><h2 "
          "id=\"{0}-title\">{1}</h2>\n{2}</section>\n",
          section.id, section.title, section.body, section.tab);
  body += markup("</main>\n<footer><p>Written by Carousel. The page needs no network.</p></footer>\n");
  if (!script.empty()) body += json_script("facts", facts) + data;
  // The program's own style and scripts are the only text that goes into a page without being escaped.
  std::string out = head.str();
  out.append("<style>").append(style).append("</style>\n").append(body.str());
  if (!script.empty()) out.append("<script>").append(script).append("</script>\n");
  return out.append("</body>\n</html>\n");
}

}  // namespace carousel::report::html
