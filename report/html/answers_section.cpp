#include <algorithm>
#include <cmath>
#include <cstdint>

#include <fmt/format.h>

#include "report/html/html.h"
#include "report/html/packed_series.h"
#include "report/html/run_sections.h"
#include "report/html/still.h"
#include "report/run/report_json.h"
#include "report/text/number_text.h"
#include "report/text/singular.h"

namespace carousel::report::html {

namespace {

std::string signed_percent(double fraction) {
  return fmt::format("{}{:.1f} %", fraction < 0 ? "−" : "+", std::abs(100 * fraction));
}

/// The gain of the class that limits the machine; null if there is none.
const Json* limiting_gain(const Json& report) {
  const Json* gains = find(report, "bottleneck.gains");
  const std::string limits = text_at(report, "bottleneck.limits");
  if (!gains || limits.empty()) return nullptr;
  for (const Json& gain : *gains)
    if (text_at(gain, "name") == limits) return &gain;
  return nullptr;
}

Html card(const char* question, const Html& answer) {
  return answer.empty() ? Html() : markup("<div class=\"card\"><h3>{}</h3>\n{}</div>\n", question, answer);
}

Html limits_card(const Json& report) {
  Html out;
  if (const Json* gain = limiting_gain(report)) {
    const std::string group = text_at(report, "bottleneck.group"), name = words(text_at(*gain, "name"));
    out += markup("<p class=\"verdict\">{}</p>\n", capital(group.empty() ? name : fmt::format("{} ({})", group, name)));
    const Json* rivals = find(report, "bottleneck.rivals");
    constexpr std::size_t kShown = 3;
    std::string names;
    for (std::size_t i = 0; rivals && i < std::min(kShown, rivals->size()); ++i)
      names += (i == 0 ? "" : ", ") + words((*rivals)[i].get<std::string>());
    if (rivals && rivals->size() > kShown) names += fmt::format(" and {} more", rivals->size() - kShown);
    if (!names.empty()) out += markup("<p>As much may be gained with: {}.</p>\n", names);
  } else {
    out += markup("<p class=\"verdict small\">{}</p>\n", singular(verdict_sentence(report)));
  }
  if (const std::string phases = phases_text(report); !phases.empty()) out += markup("<p>{}.</p>\n", phases);
  return out;
}

void reason(Html& out, const std::string& text) {
  out += markup("<li>{}</li>\n", text);
}

/// The numbers that stand behind a verdict: parts that are busy, and causes of waiting.
Html why_card(const Json& report) {
  Html out;
  const Json* bound = find(report, "bound.classes");
  if (bound && !bound->empty())
    reason(out, fmt::format("By itself, {} would allow {:.1f} rays in 1,000 cycles; the run reached {} of that.",
                            words(text_at(bound->front(), "name")), number_at(bound->front(), "rays_per_kilocycle"),
                            percent(number_at(report, "bound.reached"))));
  const double cycles = number_at(report, "engine.cycles");
  const Json* resources = find(report, "resources");
  if (cycles > 0 && resources && !resources->empty() && resources->front().contains("units")) {
    const std::size_t testing = resources_with_units(report.value("config", Json::object()), resources->size());
    const double all = cycles * static_cast<double>(testing);
    struct Wait {
      const char *key, *text;
      double amount;
    };
    Wait waits[] = {{"memory", "shape data", 0},
                    {"link", "a place in a link", 0},
                    {"credits", "a packet of their own", 0},
                    {"storage", "a free block", 0},
                    {"idle", "rays", 0}};
    double busy = 0;
    for (std::size_t i = 0; i < testing; ++i) {
      const Json* unit = find((*resources)[i], "units.box");
      if (!unit) continue;
      busy += number_at(*unit, "busy") / all;
      for (Wait& wait : waits) wait.amount += number_at(*unit, wait.key) / all;
    }
    std::sort(std::begin(waits), std::end(waits), [](const Wait& a, const Wait& b) { return a.amount > b.amount; });
    std::string text = fmt::format("Box units work in {} of the cycles", percent(busy));
    if (waits[0].amount > 0.005)
      text += fmt::format(", and testers wait for {} in {}", waits[0].text, percent(waits[0].amount));
    if (waits[1].amount > 0.005) text += fmt::format(", for {} in {}", waits[1].text, percent(waits[1].amount));
    reason(out, text + ".");
  }
  if (find(report, "memory.dram_utilisation")) {
    std::string text =
        fmt::format("DRAM moves data in {} of the cycles", percent(number_at(report, "memory.dram_utilisation")));
    if (const Json* caches = find(report, "memory.caches"); caches && !caches->empty())
      text +=
          fmt::format("; {} of the lines asked for are in the L2", percent(number_at(caches->front(), "hit_fraction")));
    reason(out, text + ".");
  }
  if (find(report, "packets.rays_mean"))
    reason(out, fmt::format(
                    "A packet holds {:.1f} rays, and finds rays of its own at {} of the resources that it visits.",
                    number_at(report, "packets.rays_mean"), percent(1 - number_at(report, "packets.bubble_fraction"))));
  if (find(report, "shading.utilisation"))
    reason(out, fmt::format("Shader workers are busy in {} of the cycles.",
                            percent(number_at(report, "shading.utilisation"))));
  return out.empty() ? out : markup("<ul>\n{}</ul>\n", out);
}

Html change_card(const Json& report) {
  Html out;
  const Json* gain = limiting_gain(report);
  if (!gain) {
    if (const Json* least = find(report, "bottleneck.frame_too_small.least_paths"))
      return markup(
          "<p>First the picture: at least {} paths, or fewer ray slots, so that the machine is full for most "
          "of the run.</p>\n",
          value_text(*least));
    return out;
  }
  std::string sets;
  for (const Json& set : (*gain)["sets"]) sets += (sets.empty() ? "--set " : " --set ") + set.get<std::string>();
  const double low = number_at(*gain, "low"), high = number_at(*gain, "high");
  out += markup(
      "<p><strong>{}</strong> gains <strong>{}</strong> ({} to {} with 95 % of confidence, other seeds of the "
      "picture included).</p>\n",
      capital(text_at(*gain, "action")), signed_percent(number_at(*gain, "gain")), signed_percent(low),
      signed_percent(high));
  if (!sets.empty()) out += markup("<p>To try it: <code>{}</code></p>\n", sets);
  return out;
}

Html cost_card(const Json& report) {
  Html out;
  const double rays = number_at(report, "rays.completed");
  const auto item = [&](const char* name, const std::string& value) {
    out += markup("<div><dt>{}</dt><dd>{}</dd></div>\n", name, value);
  };
  if (const double rate = number_at(report, "throughput.whole.rays_per_kilocycle"); rate > 0)
    item("Time", fmt::format("{:.2f} cycles of the machine ({:.1f} Mrays/s at {} MHz)", 1000 / rate,
                             number_at(report, "throughput.whole.mrays_per_second_at_clock"),
                             number_at(report, "config.engine.clock_mhz")));
  else if (const double speed = number_at(report, "host.rays_per_second"); speed > 0)
    item("Time", fmt::format("{:.0f} ns on this host ({}rays/s)", 1e9 / speed, scaled(speed)));
  if (find(report, "tests.box.per_ray"))
    item("Tests", fmt::format("{:.1f} boxes, {:.1f} triangles", number_at(report, "tests.box.per_ray"),
                              number_at(report, "tests.triangle.per_ray")));
  if (const double own = number_at(report, "tests.procedural.per_ray"); own > 0) {
    std::string text = fmt::format("{:.3g} tests of procedural primitives", own);
    if (find(report, "tests.programs"))
      text +=
          fmt::format(", {:.3g} of them by programs of {:.1f} cycles each", number_at(report, "tests.programs.per_ray"),
                      number_at(report, "tests.program_cycles.per_ray") /
                          std::max(1e-12, number_at(report, "tests.programs.per_ray")));
    item("Shapes", text);
  }
  if (const Json* bytes = find(report, "bytes"); bytes && rays > 0) {
    double all = 0, memory = 0;
    for (const Json& row : *bytes) {
      all += number_at(row, "bytes");
      if (text_at(row, "from") == "DRAM" || text_at(row, "to") == "DRAM") memory += number_at(row, "bytes");
    }
    item("Bytes",
         fmt::format("{} in all, {} of them to and from DRAM", grouped(static_cast<std::uint64_t>(all / rays + 0.5)),
                     grouped(static_cast<std::uint64_t>(memory / rays + 0.5))));
  }
  if (find(report, "energy.nj_per_ray"))
    item("Energy", fmt::format("{:.3g} nJ", number_at(report, "energy.nj_per_ray")));
  if (const double mm2 = number_at(report, "area.mm2"); mm2 > 0)
    item("Area",
         fmt::format("{:.3g} mm² for {:.3g} Mrays/s each", mm2, number_at(report, "area.mrays_per_second_per_mm2")));
  if (const Json* spared = find(report, "effects.spared"); spared && number_at(*spared, "fraction") >= 0.0005)
    item("Effects", fmt::format("{} of the cycles spared: all effects would cost {} cycles",
                                percent(number_at(*spared, "fraction")), value_text((*spared)["cycles_with_all"])));
  return out.empty() ? out : markup("<dl>\n{}</dl>\n", out);
}

Html picture_of(const Json& report, const Picture& picture) {
  if (picture.mime_type.empty()) return {};
  const auto side = [&](const char* key) {
    return static_cast<int>(std::clamp(number_at(report, std::string("config.image.") + key), 0.0, 1e6));
  };
  return markup("<img src=\"data:{};base64,{}\" width=\"{}\" height=\"{}\" alt=\"{}\">\n", picture.mime_type,
                base64(picture.bytes), side("width"), side("height"),
                singular(fmt::format("Picture of the scene {} that this run rendered, {} by {} pixels, {} samples each",
                                     text_at(report, "scene.name"), side("width"), side("height"), side("samples"))));
}

}  // namespace

std::vector<StillGain> still_gains_of(const Json& report) {
  std::vector<StillGain> out;
  const Json* gains = find(report, "bottleneck.gains");
  if (!gains) return out;
  for (const Json& gain : *gains) {
    const double together = number_at(gain, "together", 1);
    out.push_back({words(text_at(gain, "name")) + (together > 1 ? fmt::format(" (of {:.0f} together)", together) : ""),
                   fmt::format("{} ({:+.0f} to {:+.0f})", signed_percent(number_at(gain, "gain")),
                               100 * number_at(gain, "low"), 100 * number_at(gain, "high")),
                   number_at(gain, "gain"), number_at(gain, "low"), number_at(gain, "high")});
  }
  return out;
}

Html answers_section(const Json& report, const Picture& picture, const Json* versus) {
  Html out;
  if (report.value("incomplete", false))
    out += markup(
        "<p class=\"notice\"><strong>Incomplete:</strong> the run was interrupted, and its counts are partial.</p>\n");
  const Html machine = still_machine(report);
  out += markup("<div class=\"answers\">\n{}{}{}{}{}</div>\n", card("What limits it", limits_card(report)),
                card("Why", why_card(report)), card("What to change", change_card(report)),
                card("What a ray costs", cost_card(report)),
                versus == nullptr ? Html() : card("How a conventional machine does", twin_card(*versus)));
  std::vector<StillGain> gains = still_gains_of(report);
  constexpr std::size_t kGains = 5;
  if (gains.size() > kGains) gains.resize(kGains);
  Html sides = picture_of(report, picture);
  if (!machine.empty()) sides += markup("<div><h3>The machine, by use</h3>\n{}</div>\n", machine);
  if (!gains.empty())
    sides += markup("<div><h3>Gain of a better part, with its interval</h3>\n{}</div>\n", still_gains(gains));
  else if (const Html use = still_cycles(report); !use.empty())
    sides += markup("<div><h3>Use of the cycles</h3>\n{}</div>\n", use);
  if (!sides.empty()) out += markup("<div class=\"sides\">\n{}</div>\n", sides);
  return out;
}

}  // namespace carousel::report::html
