#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

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
    out +=
        markup("<p class=\"verdict\">{}</p>\n", capital((number_at(*gain, "low") > 0 ? "" : "probably ") +
                                                        (group.empty() ? name : fmt::format("{} ({})", group, name))));
    const Json* rivals = find(report, "bottleneck.rivals");
    constexpr std::size_t kShown = 3;
    std::string names;
    for (std::size_t i = 0; rivals && i < std::min(kShown, rivals->size()); ++i)
      names += (i == 0 ? "" : ", ") + words((*rivals)[i].get<std::string>());
    if (rivals && rivals->size() > kShown) names += fmt::format(" and {} more", rivals->size() - kShown);
    if (!names.empty()) out += markup("<p>As much may be gained with: {}.</p>\n", names);
    if (const std::string cold = cold_sentence(report); !cold.empty()) out += markup("<p>{}</p>\n", cold);
  } else {
    out += markup("<p class=\"verdict small\">{}</p>\n", singular(verdict_sentence(report)));
  }
  if (const std::string phases = phases_text(report); !phases.empty()) out += markup("<p>{}.</p>\n", phases);
  return out;
}

/// The subject of a sentence of the card.
enum class Topic : std::uint8_t { kRays, kTests, kLinks, kMemory, kPackets, kShading };

Topic topic_of(std::string_view part) {
  constexpr std::pair<std::string_view, Topic> kWords[] = {
      {"shading", Topic::kShading},  {"link", Topic::kLinks},   {"ring", Topic::kLinks},
      {"memory", Topic::kMemory},    {"dram", Topic::kMemory},  {"l2_", Topic::kMemory},
      {"l1_", Topic::kMemory},       {"shape", Topic::kMemory}, {"fetch", Topic::kMemory},
      {"dispatch", Topic::kPackets}, {"pack", Topic::kPackets}, {"collection", Topic::kPackets},
      {"ray_slots", Topic::kRays}};
  for (const auto& [word, topic] : kWords)
    if (part.find(word) != part.npos) return topic;
  return Topic::kTests;
}

struct WhySentence {
  Topic topic;
  std::string text;
};

std::string bound_words(const Json& report) {
  const Json* bound = find(report, "bound.classes");
  if (!bound || bound->empty()) return {};
  const std::string part = text_at(bound->front(), "name");
  return fmt::format("By {}, {} would allow {} rays in 1,000 cycles{}; the run reached {} of that.",
                     part.ends_with("s") ? "themselves" : "itself", words(part),
                     value_text(bound->front().value("rays_per_kilocycle", Json(0))),
                     part == "link_bandwidth" ? ", if all links carried as much" : "",
                     percent(number_at(report, "bound.reached")));
}

/// The use of the box units, and the two things that testers wait for most.
std::string tester_words(const Json& report) {
  const double cycles = number_at(report, "engine.cycles");
  const Json* resources = find(report, "resources");
  if (cycles <= 0 || !resources || resources->empty() || !resources->front().contains("units")) return {};
  const std::size_t testing = resources_with_units(report.value("config", Json::object()), resources->size());
  const double all = cycles * static_cast<double>(testing);
  struct Wait {
    const char *key, *text;
    double amount;
  };
  Wait waits[] = {{"latency", "their pipelines", 0}, {"memory", "shape data", 0},
                  {"link", "a place in a link", 0},  {"credits", "a packet of their own", 0},
                  {"storage", "a free block", 0},    {"idle", "rays", 0}};
  double busy = 0;
  for (std::size_t i = 0; i < testing; ++i) {
    const Json* unit = find((*resources)[i], "units.box");
    if (!unit) continue;
    busy += number_at(*unit, "busy") / all;
    for (Wait& wait : waits) wait.amount += number_at(*unit, wait.key) / all;
  }
  std::sort(std::begin(waits), std::end(waits), [](const Wait& a, const Wait& b) { return a.amount > b.amount; });
  std::string text = fmt::format("Box units are busy in {} of the cycles", percent(busy));
  if (waits[0].amount > 0.005)
    text += fmt::format(", and testers wait for {} in {}", waits[0].text, percent(waits[0].amount));
  if (waits[1].amount > 0.005) text += fmt::format(", for {} in {}", waits[1].text, percent(waits[1].amount));
  return text + ".";
}

std::string memory_words(const Json& report) {
  if (!find(report, "memory.dram_utilisation")) return {};
  std::string text =
      fmt::format("DRAM moves data in {} of the cycles", percent(number_at(report, "memory.dram_utilisation")));
  if (const Json* channels = find(report, "memory.dram.channels")) {
    double asked = 0, conflicts = 0;
    for (const Json& channel : *channels) {
      asked += number_at(channel, "reads") + number_at(channel, "writes");
      conflicts += number_at(channel, "row_conflicts");
    }
    if (asked > 0)
      text += fmt::format(", {} of its accesses find their row open and {} another one",
                          percent(number_at(report, "memory.dram.row_hit_fraction")), percent(conflicts / asked));
  }
  double lines = 0, hits = 0;
  if (const Json* caches = find(report, "memory.caches"))
    for (const Json& cache : *caches) {
      lines += number_at(cache, "lines");
      hits += number_at(cache, "hits");
    }
  if (lines > 0) text += fmt::format("; {} of the lines asked for are in the L2", percent(hits / lines));
  if (number_at(report, "memory.shape_buffers.misses") > 0)
    text += fmt::format(", {} of the shapes in the shape buffers",
                        percent(number_at(report, "memory.shape_buffers.hit_fraction")));
  return text + ".";
}

/// The numbers that stand behind a verdict: parts that are busy, and causes of waiting. Those of the part that limits
/// the machine, or that is tightest, come first.
Html why_card(const Json& report) {
  std::vector<WhySentence> reasons;
  const auto add = [&](Topic topic, const std::string& text) {
    if (!text.empty()) reasons.push_back({topic, text});
  };
  add(Topic::kRays, longest_stages(report));
  add(Topic::kTests, tester_words(report));
  add(Topic::kMemory, memory_words(report));
  if (const BusiestLink link = busiest_link(report); link.use > 0.5 || link.use > 2 * link.mean)
    add(Topic::kLinks, link.text);
  if (number_at(report, "packets.issued") > 0)
    add(Topic::kPackets,
        fmt::format("A packet holds {:.1f} rays, and finds rays of its own at {} of the resources that "
                    "it visits.",
                    number_at(report, "packets.rays_mean"), percent(1 - number_at(report, "packets.bubble_fraction"))));
  if (find(report, "shading.utilisation"))
    add(Topic::kShading,
        fmt::format("Shader workers are busy in {} of the cycles.", percent(number_at(report, "shading.utilisation"))));
  std::string part = text_at(report, "bottleneck.limits");
  if (const Json* bound = find(report, "bound.classes"); part.empty() && bound && !bound->empty())
    part = text_at(bound->front(), "name");
  std::stable_partition(reasons.begin(), reasons.end(),
                        [&](const WhySentence& reason) { return !part.empty() && reason.topic == topic_of(part); });
  // On one screen: what else is known stands behind the tabs.
  constexpr std::size_t kMost = 4;
  if (reasons.size() > kMost) reasons.resize(kMost);
  Html out;
  const auto item = [&](const std::string& text) { out += markup("<li>{}</li>\n", text); };
  if (const std::string bound = bound_words(report); !bound.empty()) item(bound);
  for (const WhySentence& reason : reasons) item(reason.text);
  return out.empty() ? out : markup("<ul>\n{}</ul>\n", out);
}

/// With a capital at the start, unless a key stands there.
std::string action_words(const std::string& action) {
  const std::size_t end = std::min(action.find(' '), action.size());
  return action.find('.') < end ? action : capital(action);
}

Html change_card(const Json& report) {
  Html out;
  const Json* gain = limiting_gain(report);
  if (!gain) {
    if (const Json* least = find(report, "bottleneck.frame_too_small.least_paths")) {
      out += markup(
          "<p>First the picture: at least {} paths, or fewer ray slots, so that the machine is full for most "
          "of the run.</p>\n",
          value_text(*least));
      const double paths = number_at(report, "bottleneck.frame_too_small.paths");
      if (const double samples = number_at(report, "config.image.samples"); samples > 0 && paths > 0)
        out += markup("<p>To try it: <code>--set image.samples={}</code></p>\n",
                      std::ceil(samples * number_at(report, "bottleneck.frame_too_small.least_paths") / paths));
      return out;
    }
    const BusiestLink link = busiest_link(report);
    if (find(report, "bottleneck"))
      out += markup("<p>The gain of a change was not measured.{}</p>\n", link.use > 0.9 ? " " + link.text : "");
    return out;
  }
  std::string sets;
  for (const Json& set : (*gain)["sets"]) sets += (sets.empty() ? "--set " : " --set ") + set.get<std::string>();
  const double low = number_at(*gain, "low"), high = number_at(*gain, "high");
  out += markup(
      "<p><strong>{}</strong> gains <strong>{}</strong> ({} to {} with 95 % of confidence, other seeds of the "
      "picture included).</p>\n",
      action_words(text_at(*gain, "action")), signed_percent(number_at(*gain, "gain")), signed_percent(low),
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
    item("Time", fmt::format("{} ns on this host ({}rays/s)", value_text(Json(1e9 / speed)), scaled(speed)));
  if (const double latency = number_at(report, "ray_time.latency"); latency > 0)
    item("Latency", fmt::format("{} cycles until it is shaded", value_text(Json(latency))));
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
