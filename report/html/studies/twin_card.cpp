#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "report/html/html.h"
#include "report/html/run_page.h"
#include "report/html/run_sections.h"

namespace carousel::report::html {

namespace {

/// A ratio of this machine's to the twin's, in words: "1.30 times the energy (1.25 to 1.36)". Near 1 it has a digit
/// more.
std::string times_text(const Json& ratio, const char* more) {
  const double mean = number_at(ratio, "ratio");
  const int digits = std::abs(mean - 1) < 0.1 ? 3 : 2;
  std::string out = fmt::format("{:.{}f} times {}", mean, digits, more);
  if (find(ratio, "low"))
    out += fmt::format(" ({:.{}f} to {:.{}f})", number_at(ratio, "low"), digits, number_at(ratio, "high"), digits);
  return out;
}

}  // namespace

bool is_of_run(const Json& versus, const Json& report) {
  const Json *cycles = find(report, "engine.cycles"), *runs = find(versus, "runs");
  return cycles && runs && std::any_of(runs->begin(), runs->end(), [&](const Json& run) {
           return text_at(run, "machine") == "machine" && run["cycles"] == *cycles &&
                  text_at(run, "hits") == text_at(report, "digest.hits");
         });
}

Html twin_card(const Json& versus) {
  Html out;
  for (const Json& pair : versus["against"]) {
    const bool equal_area = text_at(pair, "than") != "twin";
    const std::string verdict = text_at(pair, "verdict");
    std::string text = fmt::format("{}, this machine is {}: {}",
                                   equal_area ? "Against a twin of the same area" : "Against its conventional twin",
                                   verdict == "alike" ? "neither surely faster nor slower" : verdict,
                                   times_text(pair["speed"], "the rays a cycle"));
    text += fmt::format("; {}, {}.", times_text(pair["bytes"], "the bytes of memory a ray"),
                        times_text(pair["joules"], "the energy"));
    out += markup("<p>{}</p>\n", text);
  }
  for (const Json& machine : versus["machines"])
    if (const std::string limits = text_at(machine, "limits"); text_at(machine, "name") == "twin" && !limits.empty())
      out += markup("<p>The tightest part of the twin is {}.</p>\n", words(limits));
  return out;
}

}  // namespace carousel::report::html
