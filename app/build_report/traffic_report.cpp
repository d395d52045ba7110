#include "app/build_report/traffic_report.h"

#include <algorithm>

#include "app/build_report/build_report.h"
#include "app/build_report/ring_sections.h"
#include "core/config/config.h"
#include "report/text/ratio.h"

namespace carousel::app {

using report::ratio;

namespace {

report::Traffic traffic(const Config& config, const ringbus::TrafficResult& result) {
  report::Traffic out;
  out.packets = result.packets;
  out.delivered = result.delivered;
  out.flits_per_packet = result.flits;
  out.window_begin = result.window_begin;
  out.window_end = result.window_end;
  out.measured = result.offered;
  const std::uint64_t resource_cycles =
      (result.window_end - result.window_begin) * static_cast<std::uint64_t>(config.topology.resources);
  out.accepted_of_links = result.accepted_of_links();
  out.offered = ratio(result.offered, resource_cycles);
  out.accepted = ratio(result.accepted, resource_cycles);
  out.routers_mean = result.routers_mean();
  out.zero_load_latency = result.zero_load_latency(config.workload.traffic);
  out.latency = report::latency_of(result.latency);
  out.least_latency = result.latency.quantile(0);
  const TrafficConfig& asked = config.workload.traffic;
  const double seconds = static_cast<double>(result.window_end - result.window_begin) /
                         (static_cast<double>(config.engine.clock_mhz) * 1e6);
  out.gigabytes_per_second =
      ratio(static_cast<double>(result.accepted) * static_cast<double>(asked.packet_bytes + asked.reply_bytes),
            seconds * 1e9);
  double busiest = 0, windows = 0;
  for (std::size_t i = 0; i < result.busy_in_window.size(); ++i) {
    out.flit_hops += result.busy_in_window[i];  // a flit a cycle
    busiest = std::max(busiest, ratio(result.busy_in_window[i], result.link_windows[i]));
    windows += static_cast<double>(result.link_windows[i]);
  }
  if (const auto& stops = result.stops)
    out.stops = report::RingStopsUse{stops->extra_rounds, stops->longest_ride, stops->longest_wait, stops->reservations,
                                     stops->starts};
  out.link_utilisation = {ratio(static_cast<double>(out.flit_hops), windows), busiest};
  return out;
}

std::vector<report::Link> links(const Config& config, const ringbus::TrafficResult& result) {
  std::vector<report::Link> out;
  for (std::size_t i = 0; i < result.links.size(); ++i) {
    const ringbus::cycle::LinkUse& link = result.links[i];
    report::Link& one = out.emplace_back();
    one.from = link.from;
    one.to = link.to;
    one.depth = result.link_depths[i];
    one.packets = result.link_packets[i];
    const std::uint64_t cycles = result.link_cycles[i];
    if (several_clocks(config)) one.clock = clock_of_link(config, link.mhz);
    one.utilisation = ratio(link.use.busy, cycles);
    one.cycles = report::LinkCycles{link.use.busy, link.use.stalled, cycles - link.use.busy - link.use.stalled};
  }
  return out;
}

}  // namespace

report::Report traffic_report(const Prepared& prepared, const ringbus::TrafficResult& result) {
  const Config& config = prepared.config();
  report::Report r = report_without_rays(prepared, result.complete, result.cycles, result.threads, result.wall_seconds);
  add_clocks(r, config);
  r.links = links(config, result);
  r.drawing = drawing(config.topology);
  r.traffic = traffic(config, result);
  if (several_clocks(config)) r.traffic->mean_nanoseconds = nanoseconds(config, r.traffic->latency.mean);
  return r;
}

}  // namespace carousel::app
