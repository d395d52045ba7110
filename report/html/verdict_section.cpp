#include <algorithm>

#include <fmt/format.h>

#include "report/html/html.h"
#include "report/html/run_sections.h"
#include "report/text/number_text.h"
#include "report/text/singular.h"

namespace carousel::report::html {

std::string cold_sentence(const Json& report) {
  const Json* cold = find(report, "bottleneck.cold_caches");
  if (!cold) return "";
  const std::string limits = text_at(report, "bottleneck.limits"), warm = text_at(*cold, "when_warm");
  return fmt::format(
      "{} of the lines that memory reads are read for the first time, so this gains less in a larger "
      "picture{}.",
      percent(number_at(*cold, "first") / std::max(1.0, number_at(*cold, "reads"))),
      warm == limits ? "" : fmt::format(", where {} may gain most", warm.empty() ? "another class" : words(warm)));
}

std::string verdict_sentence(const Json& report) {
  const Json* bottleneck = find(report, "bottleneck");
  const std::string limits = bottleneck ? text_at(*bottleneck, "limits") : "";
  if (!limits.empty() && !(*bottleneck)["gains"].empty()) {
    for (const Json& gain : (*bottleneck)["gains"]) {
      if (text_at(gain, "name") != limits) continue;
      const double low = number_at(gain, "low"), high = number_at(gain, "high");
      const std::string group = text_at(*bottleneck, "group");
      std::string out = fmt::format("this machine is {}limited by {}: {} gains {:+.1f} %", low > 0 ? "" : "probably ",
                                    group.empty() ? words(limits) : fmt::format("{} ({})", group, words(limits)),
                                    text_at(gain, "action"), 100 * number_at(gain, "gain"));
      out += fmt::format(" (95 % of confidence, other seeds of the picture included: {:+.1f} % to {:+.1f} %)",
                         100 * low, 100 * high);
      if (const Json& rivals = (*bottleneck)["rivals"]; !rivals.empty()) {
        constexpr std::size_t kShown = 3;
        out += "; as much may be gained with";
        for (std::size_t i = 0; i < rivals.size() && i < kShown; ++i)
          out += (i == 0 ? " " : ", ") + words(rivals[i].get<std::string>());
        if (rivals.size() > kShown) out += fmt::format(" and {} more", rivals.size() - kShown);
      }
      const std::string cold = cold_sentence(report);
      return capital(out) + "." + (cold.empty() ? "" : " " + cold);
    }
  }
  if (bottleneck) return capital(sentence_words(text_at(*bottleneck, "verdict"))) + ".";
  if (find(report, "traffic"))
    return fmt::format(
        "The network accepted {:.4f} of {:.4f} offered packets a resource and cycle, with a mean latency of "
        "{:.1f} cycles.",
        number_at(report, "traffic.accepted"), number_at(report, "traffic.offered"),
        number_at(report, "traffic.latency.mean"));
  if (find(report, "memory_trace"))
    return fmt::format("The memory moved {:.3f} bytes a cycle, with a mean latency of {:.1f} cycles.",
                       number_at(report, "memory_trace.bytes_per_cycle"),
                       number_at(report, "memory_trace.latency.mean"));
  if (find(report, "sampled"))
    return "The limiting part is not searched for by a part of the frame; without sampling.fraction it is.";
  if (const Json* asked = find(report, "config.engine.what_if"); asked && asked->is_boolean() && asked->get<bool>())
    return "The limiting part was not searched for in this run.";
  if (find(report, "engine.cycles"))
    return "The search for the limiting part was switched off; engine.what_if: true turns it on.";
  return "A run of the native engine shows the queues of this host and no simulated time, so that no part of the "
         "machine "
         "can be named as its limit. The cycle engine names it: --set engine.kind=cycle.";
}

std::string phases_text(const Json& report) {
  const Json* phases = find(report, "bottleneck.phases");
  std::string out;
  if (!phases || phases->size() < 2) return out;
  for (const Json& phase : *phases) {
    const std::string limits = text_at(phase, "limits");
    out += fmt::format("{}{:.0f} to {:.0f} % of the rays ({:.0f} % of the time): {}", out.empty() ? "" : "; ",
                       100 * number_at(phase, "begin"), 100 * number_at(phase, "end"), 100 * number_at(phase, "time"),
                       limits.empty() ? "no class alone"
                                      : fmt::format("{} ({:+.1f} %)", words(limits), 100 * number_at(phase, "gain")));
  }
  return out;
}

namespace {

void fact(Html& out, std::string_view name, const std::string& value) {
  if (!value.empty()) out += markup("<div><dt>{}</dt><dd>{}</dd></div>\n", name, singular(value));
}

std::string throughput_text(const Json& report) {
  if (find(report, "throughput.whole")) {
    std::string text = fmt::format("{:.2f} rays per 1,000 cycles, {:.1f} Mrays/s at {} MHz",
                                   number_at(report, "throughput.whole.rays_per_kilocycle"),
                                   number_at(report, "throughput.whole.mrays_per_second_at_clock"),
                                   number_at(report, "config.engine.clock_mhz"));
    if (find(report, "throughput.steady"))
      text += fmt::format("; steady {:.2f}", number_at(report, "throughput.steady.rays_per_kilocycle"));
    return text;
  }
  if (find(report, "traffic") || find(report, "memory_trace")) return "";
  return scaled(number_at(report, "host.rays_per_second")) + "rays/s on this host";
}

}  // namespace

std::string machine_words(const Json& report) {
  const std::string shape = words(text_at(report, "config.topology.shape", "ring"));
  const Json* count = find(report, "config.topology.resources");
  std::string out = singular(fmt::format("{} resources, {}", count ? value_text(*count) : "0", shape));
  if (shape == "multi ring") out += fmt::format(" of {}", number_at(report, "config.topology.rings"));
  if (shape == "hierarchical") out += fmt::format(" of {} groups", number_at(report, "config.topology.groups"));
  return out + fmt::format(", {} engine", text_at(report, "engine.kind"));
}

Html verdict_section(const Json& report) {
  Html out;
  out += markup("<dl>\n");
  fact(out, "Verdict", verdict_sentence(report));
  fact(out, "Phases", phases_text(report));
  fact(out, "Throughput", throughput_text(report));
  if (const Json* cycles = find(report, "engine.cycles"))
    fact(out, "Simulated", fmt::format("{} cycles", value_text(*cycles)));
  if (const Json* rays = find(report, "rays"); rays && number_at(*rays, "emitted") > 0)
    fact(out, "Rays",
         fmt::format("{} emitted, {} completed, {} lost", value_text((*rays)["emitted"]),
                     value_text((*rays)["completed"]), value_text((*rays)["lost"])));
  if (const Json* traffic = find(report, "traffic"))
    fact(out, "Packets",
         fmt::format("{} created, {} delivered", value_text((*traffic)["packets"]),
                     value_text((*traffic)["delivered"])));
  if (find(report, "scene.triangles") && number_at(report, "scene.triangles") > 0)
    fact(out, "Scene",
         fmt::format("{}: {} triangles, {} instances", text_at(report, "scene.name"),
                     value_text(report["scene"]["triangles"]), value_text(report["scene"]["instances"])));
  if (find(report, "verify"))
    fact(out, "Verified",
         fmt::format("{} rays traced again, {} mismatches", value_text(report["verify"]["compared"]),
                     value_text(report["verify"]["mismatches"])));
  if (text_at(report, "digest.hits") != "") fact(out, "Digest of the hits", text_at(report, "digest.hits"));
  fact(out, "Digest of the picture", text_at(report, "digest.image"));
  fact(out, "Host",
       fmt::format("{}, {} threads, {}", text_at(report, "host.machine.cpu"), number_at(report, "host.threads"),
                   seconds_text(number_at(report, "host.wall_seconds"))));
  fact(out, "Program",
       fmt::format("Carousel {} ({}, {})", text_at(report, "carousel.version"), text_at(report, "carousel.commit"),
                   text_at(report, "carousel.compiler")));
  out += markup(
      "</dl>\n<h3>To reproduce this run</h3>\n<pre tabindex=\"0\"><code>carousel run "
      "config.resolved.yaml --out again\ncarousel compare . "
      "again</code></pre>\n");
  out += find(report, "engine.deterministic") && report["engine"].value("deterministic", false)
             ? markup(
                   "<p>Everything outside of the section <i>host</i> is the same in every run of this "
                   "configuration.</p>\n")
             : markup(
                   "<p>Rays, hits and picture are the same in every run of this configuration; counts that depend on "
                   "the timing of threads are not.</p>\n");
  return out;
}

}  // namespace carousel::report::html
