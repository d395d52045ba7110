#include "app/build_report/ring_sections.h"

#include <algorithm>
#include <chrono>

#include <fmt/format.h>

#include "app/build_report/nodes_section.h"
#include "core/config/config.h"
#include "core/config/graph/clocks.h"
#include "core/config/graph/graph.h"
#include "core/config/graph/ring.h"
#include "core/config/own_sections.h"
#include "core/types/enum_names.h"
#include "core/types/ray.h"
#include "report/text/ratio.h"
#include "ringbus/cycle/parcels/parcel_plan.h"
#include "ringbus/results/run_features.h"
#include "ringbus/time/clock_ratio.h"
#include "ringbus/topology/topology.h"

namespace carousel::app {

using report::ratio;

namespace {

/// Peaks of two resources need not have been at one time, so the greater one is kept.
void add_apart(CollectionCounts& to, const CollectionCounts& from) {
  const std::uint64_t peak = std::max(to.peak, from.peak),
                      memberships = std::max(to.memberships_peak, from.memberships_peak);
  to += from;
  to.peak = peak;
  to.memberships_peak = memberships;
}

}  // namespace

void add_ring(report::Report& r, const ringbus::RunResult& result, const Config& config, const accel::Accel& accel) {
  const std::uint64_t rays = result.rays_completed;
  ringbus::ResourceStatistics sum;
  report::Collections& collections = r.collections.emplace();
  r.resources.emplace();
  for (std::size_t i = 0; i < result.resources.size(); ++i) {
    const ringbus::ResourceStatistics& s = result.resources[i];
    sum += s;
    add_apart(collections.counts, result.collections[i]);
    report::Resource& resource = r.resources->emplace_back();
    resource = {i, s, s.tests, result.collections[i]};
    if (result.cycle)
      resource.reserve_entered = s.stalls[StallReason::kReserve];
    else
      resource.stalls = s.stalls;
  }
  collections.fullness_mean =
      ratio(sum.packet_rays, sum.packets_issued * static_cast<std::uint64_t>(config.packets.rays));
  r.tests = report::Tests{sum.tests, sum.reads, rays, ringbus::features_of(config, accel)};
  if (!sum.nodes.empty() && !accel.partition) r.nodes = nodes_section(accel, sum.nodes);
  if (!sum.bundles.empty()) r.tests->bundles = report::Bundles{sum.bundles, sizeof(RayRecord)};
  if (!accel.planes.empty())
    r.cull_planes = report::CullPlanes{accel.planes.size(), accel.plane_bytes,
                                       ratio(accel.plane_bytes, accel.nodes.size()), sum.culls};
  r.packets = report::Packets{sum};
  r.throughput =
      report::Throughput{ratio(sum.packets_issued, rays), ratio(sum.hops, rays), ratio(sum.tests.tests(), rays)};
}

void add_nearest(report::Report& r, const ringbus::RunResult& result, const Config& config) {
  if (!result.nearest) return;
  const QueryConfig& query = config.rays.query;
  report::Nearest& out = r.nearest.emplace();
  out.nearest = static_cast<std::uint64_t>(query.nearest);
  out.buffer = static_cast<std::uint64_t>(query.buffered());
  out.buffer_bytes = out.buffer * kBufferedHitBytes * static_cast<std::uint64_t>(all_slots(config));
  out.counts = result.nearest->use.counts;
  out.digest = result.nearest->digest.hex();
  for (const RoundVisits& round : result.nearest->use.rounds) {
    out.visits += round.visits;
    out.rounds.push_back({out.rounds.size(), round});
  }
}

void add_census(report::Report& r, const RayCensus& census, const accel::Accel& accel) {
  r.rays.by_bounce = census.by_bounce();
  if (r.tests && !accel.partition) r.tests->depth_first = census.depth_first(accel);  // no rank has it all
}

namespace {

/// Sends for which the links from one rank to another had too few places.
std::uint64_t full_between(const ringbus::RunResult& result, const ringbus::RankResult& from,
                           const ringbus::RankResult& to) {
  const auto plays = [](const ringbus::RankResult& rank, ResourceId id) {
    return id.value >= rank.first_resource && id.value - rank.first_resource < rank.resources;
  };
  std::uint64_t full = 0;
  for (const ringbus::LinkResult& link : result.links)
    if (plays(from, link.from) && plays(to, link.to)) full += link.statistics.full_stalls;
  return full;
}

}  // namespace

void add_ranks(report::Report& r, const ringbus::RunResult& result) {
  if (result.ranks.empty()) return;
  r.ranks.emplace();
  r.rank_links.emplace();
  for (std::size_t from = 0; from < result.ranks.size(); ++from) {
    const ringbus::RankResult& rank = result.ranks[from];
    r.ranks->push_back(
        {from, rank.first_resource, rank.resources, rank.threads, rank.rays_completed, rank.waiting, rank.memory});
    for (std::size_t to = 0; to < rank.to.size(); ++to)
      if (to != from)
        r.rank_links->push_back({from, to, rank.to[to], ratio(rank.to[to].packets, rank.to[to].messages),
                                 ratio(double(rank.to[to].hold_ns) * 1e-9, result.wall_seconds),
                                 full_between(result, rank, result.ranks[to])});
  }
}

namespace {

report::RayQueue ray_queue(const RayQueueConfig& config, const QueueUse& use) {
  return {std::string(enum_name(config.kind)), use.places,      use.sent, ratio(use.rays, use.sent), use.refusals,
          ratio(use.waiting_sum, use.sent),    use.waiting_most};
}

}  // namespace

void add_ray_queues(report::Report& r, const ringbus::RunResult& result, const Config& config) {
  if (config.engine.kind != EngineKind::kNative) return;
  r.host.ray_queues = {ray_queue(config.shading.queue, result.completed), ray_queue(config.rays.queue, result.groups)};
}

namespace {

/// Returns what each link carries, in the order of the rows: links with packets, then those without, then those between
/// stops of rings. It is empty where links carry packets alone, as the queues of the native engine do.
std::vector<std::string> carried_by_rows(const Config& config) {
  if (config.engine.kind == EngineKind::kNative) return {};
  const ringbus::ParcelPlan plan = ringbus::plan_parcels(config.topology, config.memory.line_bytes);
  if (!plan.any()) return {};
  std::vector<std::string> with, without, stops;
  for (const config::Graph::Link& link : plan.graph.links) {
    std::string text;
    for (const Carried what : link.carries) text += (text.empty() ? "" : ", ") + std::string(enum_name(what));
    const bool packets = link.carries_any({Carried::kPackets}) && config.topology.resources > 1;
    (!packets ? without : config::has_stops(config.topology.links[link.entry]) ? stops : with).push_back(text);
  }
  with.insert(with.end(), without.begin(), without.end());
  with.insert(with.end(), stops.begin(), stops.end());
  return with;
}

}  // namespace

void add_links(report::Report& r, const ringbus::RunResult& result, const Config& config) {
  r.links.emplace();
  const ringbus::Topology topology(config.topology);
  const std::vector<std::string> carries = carried_by_rows(config);
  for (const ringbus::LinkResult& link : result.links) {
    const ringbus::LinkStatistics& s = link.statistics;
    r.links->push_back({link.from.value, link.to.value, link.depth, s.packets, ratio(s.occupancy_sum, s.samples),
                        s.occupancy_max, s.refusals});
    report::Link& out = r.links->back();
    if (config.faults.links.any()) out.faults = link.faults;
    if (!carries.empty()) out.carries = carries[r.links->size() - 1];
    if (config.engine.kind == EngineKind::kCycle) continue;
    const auto& own = topology.wires()[r.links->size() - 1].queue;
    out.queue = enum_name(own.value_or(config.topology.link.queue));
    out.sent_at_once = ratio(s.packets, s.batches);
    out.received_at_once = ratio(s.packets, s.receives);
    out.full_stalls = s.full_stalls;
    out.empty_stalls = s.empty_stalls;
    if (!r.host.links) r.host.links.emplace();
    std::vector<report::LinkOccupancy>& occupancy =
        r.host.links->emplace_back(report::HostLink{link.from.value, link.to.value, {}}).occupancy;
    for (const ringbus::OccupancySeries::Entry& entry : link.series.entries())
      occupancy.push_back({std::chrono::duration<double>(entry.end - result.start).count(),
                           ratio(entry.sum, entry.samples), entry.most});
  }
}

bool several_clocks(const Config& config) {
  return config::used_clocks(config.topology, config.engine.clock_mhz).size() > 1;
}

double nanoseconds(const Config& config, double cycles) {
  return cycles * 1000 / static_cast<double>(config.engine.clock_mhz);
}

std::string clock_of_link(const Config& config, std::int64_t mhz) {
  for (const config::UsedClock& clock : config::used_clocks(config.topology, config.engine.clock_mhz))
    if (mhz != 0 && clock.mhz == mhz) return clock.name;
  return "core";
}

void add_clocks(report::Report& r, const Config& config) {
  const std::vector<config::UsedClock> clocks = config::used_clocks(config.topology, config.engine.clock_mhz);
  if (clocks.size() < 2 || !r.engine.cycles) return;
  r.engine.nanoseconds = nanoseconds(config, static_cast<double>(*r.engine.cycles));
  r.clocks.emplace();
  for (const config::UsedClock& clock : clocks)
    r.clocks->push_back({clock.name, clock.mhz,
                         ringbus::ClockRatio(config.engine.clock_mhz, clock.mhz, 0).to_network(*r.engine.cycles)});
}

std::optional<std::vector<report::DrawnNode>> drawing(const TopologyConfig& topology, bool rays) {
  if (topology.shape != TopologyShape::kGraph) return std::nullopt;
  std::vector<config::GraphIssue> issues;  // none in a configuration that has run
  std::vector<report::DrawnNode> out;
  const config::Graph graph = config::draw_graph(topology, issues);
  for (const config::Graph::Node& node : graph.nodes) {
    report::DrawnNode& one = out.emplace_back(report::DrawnNode{node.name});
    if (!node.at.given) continue;
    one.x_mm = node.at.x;
    one.y_mm = node.at.y;
  }
  if (!rays && config::lone_stop_ring_entry(topology)) return out;
  // The ports of the stops lead to their ring, a node behind all others, in the middle of its stops.
  const std::vector<config::StopRing> rings = config::stop_rings(topology, graph);
  for (const config::StopRing& ring : rings) {
    report::DrawnNode& one =
        out.emplace_back(report::DrawnNode{rings.size() == 1 ? "ring" : fmt::format("ring[{}]", &ring - rings.data())});
    GraphPoint sum;
    bool placed = true;
    for (const std::uint32_t stop : ring.nodes) {
      const GraphPoint& at = graph.nodes[stop].at;
      placed = placed && at.given;
      sum.x += at.x;
      sum.y += at.y;
    }
    if (!placed) continue;
    one.x_mm = sum.x / static_cast<double>(ring.nodes.size());
    one.y_mm = sum.y / static_cast<double>(ring.nodes.size());
  }
  return out;
}

}  // namespace carousel::app
