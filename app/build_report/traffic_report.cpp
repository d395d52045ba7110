#include "app/build_report/traffic_report.h"

#include <algorithm>

#include "accel/traverse/kernels.h"
#include "app/build_report/ring_sections.h"
#include "app/host/machine_info.h"
#include "app/host/program_info.h"
#include "app/plugins/plugins.h"
#include "core/config/config.h"
#include "core/config/write.h"
#include "core/numeric/digest.h"
#include "core/system/process_memory.h"
#include "core/types/enum_names.h"
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
  report::Report r;
  r.incomplete = !result.complete;
  r.carousel = program_info();
  r.config = config_json(prepared.absolute_config());
  for (const IgnoredKey& ignored : prepared.ignored()) r.ignored_keys.push_back(ignored.key);
  r.plugins = plugins_section(prepared.located.plugins);
  r.scene.name = "none";
  r.engine.kind = enum_name(config.engine.kind);
  r.engine.cycles = result.cycles;
  add_clocks(r, config);
  r.engine.deterministic = true;
  r.engine.reason = "virtual time: nothing depends on the host's threads";
  r.links = links(config, result);
  r.drawing = drawing(config.topology);
  r.traffic = traffic(config, result);
  if (several_clocks(config)) r.traffic->mean_nanoseconds = nanoseconds(config, r.traffic->latency.mean);
  r.digest.hits = HitsDigest().hex();  // the digest of no rays
  r.host.threads = result.threads;
  r.host.wall_seconds = result.wall_seconds;
  r.host.peak_memory_bytes = peak_memory_bytes();
  r.host.simd = accel::simd_targets().front();
  r.host.machine = machine_info();
  return r;
}

}  // namespace carousel::app
