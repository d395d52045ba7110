#include "report/run/traffic_table.h"

#include <fmt/format.h>

#include "report/text/number_text.h"
#include "report/text/ratio.h"

namespace carousel::report {

namespace {

std::string network_text(const nlohmann::ordered_json& config) {
  const auto topology = config.find("topology"), workload = config.find("workload");
  if (topology == config.end() || workload == config.end()) return "";
  const auto traffic = workload->find("traffic");
  if (traffic == workload->end()) return "";
  return fmt::format(": {} traffic on {} resources, {}", traffic->value("pattern", ""), topology->value("resources", 0),
                     topology->value("shape", ""));
}

}  // namespace

std::string traffic_table(const Report& report) {
  const Traffic& t = *report.traffic;
  std::string out;
  const auto line = [&](std::string_view name, const std::string& text) {
    out += fmt::format("{:<13}{}\n", name, text);
  };
  if (report.incomplete) line("INCOMPLETE", "the work was interrupted; this is the part that was done");
  line("network", report.engine.kind + network_text(report.config));
  line("packets", fmt::format("{} created   {} delivered   {} flits each   {} measured, created from cycle {} to {}",
                              grouped(t.packets), grouped(t.delivered), t.flits_per_packet, grouped(t.measured),
                              grouped(t.window_begin), grouped(t.window_end)));
  line("load", fmt::format("{:.5f} offered   {:.5f} accepted packets per resource and cycle   {} of the links' time   "
                           "{:.4g} GB/s",
                           t.offered, t.accepted, percent(t.accepted_of_links), t.gigabytes_per_second));
  line("latency", fmt::format("{:.3f} mean   {} least   {} p50   {} p95   {} p99   {} max cycles", t.latency.mean,
                              grouped(t.least_latency), grouped(t.latency.p50), grouped(t.latency.p95),
                              grouped(t.latency.p99), grouped(t.latency.max)));
  line("",
       fmt::format("{:.3f} with nobody in the way, at {:.4f} resources visited", t.zero_load_latency, t.routers_mean));
  line("links", fmt::format("{} busy on average, {} the busiest   {} flit-hops", percent(t.link_utilisation.mean),
                            percent(t.link_utilisation.max), grouped(t.flit_hops)));
  if (t.stops)
    line("stops",
         fmt::format("{} extra rounds   {} cycles the longest ride   {} cycles the longest wait   {} reservations",
                     grouped(t.stops->extra_rounds), grouped(t.stops->longest_ride), grouped(t.stops->longest_wait),
                     grouped(t.stops->reservations)));
  line("simulated", grouped(report.engine.cycles.value_or(0)) + " cycles");
  line("host",
       fmt::format("{} to simulate on {} threads   {}flit-hops/s", seconds_text(report.host.wall_seconds),
                   report.host.threads, scaled(ratio(static_cast<double>(t.flit_hops), report.host.wall_seconds))));
  return out;
}

}  // namespace carousel::report
