#include "bench/cycle/cycle_results.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench/common/result_json.h"

namespace carousel::bench {

namespace {

using Json = nlohmann::ordered_json;

// The goals (issue 4): 40 times BookSim2, and by the number of resources.
constexpr double kAimFlitHops = 40 * Peers::kBookSimFlitHops, kAimHops = 20e6;
double aim_rays(std::uint64_t resources) {
  return resources <= 16 ? 0.12e6 : 0.05e6;
}

}  // namespace

std::string to_json_text(const CycleBenchResult& r) {
  Json out{{"machine", json_of(r.machine)},
           {"repetitions", r.repetitions},
           {"peers",
            {{"booksim2_flit_hops_per_cpu_second", Peers::kBookSimFlitHops},
             {"arches_rays_per_second", Peers::kArchesRays}}},
           {"traffic", Json::array()},
           {"rays", Json::array()},
           {"memory", Json::array()}};
  for (const TrafficSpeed& t : r.traffic)
    out["traffic"].push_back({{"name", t.name},
                              {"resources", t.resources},
                              {"cycles", t.cycles},
                              {"flit_hops", t.flit_hops},
                              {"flit_hops_per_cpu_second", json_of(t.flit_hops_per_cpu_second)},
                              {"times_booksim2", t.flit_hops_per_cpu_second.median / Peers::kBookSimFlitHops},
                              {"aim", kAimFlitHops}});
  for (const RaySpeed& s : r.rays)
    out["rays"].push_back({{"name", s.name},
                           {"resources", s.resources},
                           {"threads", s.threads},
                           {"rays", s.rays},
                           {"cycles", s.cycles},
                           {"hops", s.hops},
                           {"rays_per_cpu_second", json_of(s.rays_per_cpu_second)},
                           {"hops_per_cpu_second", json_of(s.hops_per_cpu_second)},
                           {"rays_per_wall_second", json_of(s.rays_per_wall_second)},
                           {"times_arches", s.rays_per_cpu_second.median / Peers::kArchesRays},
                           {"aim_rays", aim_rays(s.resources)},
                           {"aim_hops", kAimHops}});
  for (const MemorySpeed& m : r.memory)
    out["memory"].push_back({{"name", m.name},
                             {"requests", m.requests},
                             {"cycles", m.cycles},
                             {"requests_per_cpu_second", json_of(m.requests_per_cpu_second)}});
  return out.dump(2) + "\n";
}

std::string cycle_tables(const CycleBenchResult& r) {
  std::string out =
      fmt::format("| traffic | M flit-hops per CPU-second | times BookSim2 (aim 40) |\n|---|---:|---:|\n");
  for (const TrafficSpeed& t : r.traffic)
    out +=
        fmt::format("| {} resources, {} | {:.1f} ({:.1f} to {:.1f}) | {:.1f} |\n", t.resources, t.name,
                    1e-6 * t.flit_hops_per_cpu_second.median, 1e-6 * t.flit_hops_per_cpu_second.min,
                    1e-6 * t.flit_hops_per_cpu_second.max, t.flit_hops_per_cpu_second.median / Peers::kBookSimFlitHops);
  out += fmt::format(
      "\n| rays | threads | k rays per CPU-second | aim | times Arches | M hops per CPU-second (aim {:.0f}) | hops a "
      "ray | k rays per second |\n"
      "|---|---:|---:|---:|---:|---:|---:|---:|\n",
      1e-6 * kAimHops);
  for (const RaySpeed& s : r.rays)
    out += fmt::format("| {} | {} | {:.1f} ({:.1f} to {:.1f}) | {:.0f} | {:.1f} | {:.1f} | {:.1f} | {:.1f} |\n", s.name,
                       s.threads, 1e-3 * s.rays_per_cpu_second.median, 1e-3 * s.rays_per_cpu_second.min,
                       1e-3 * s.rays_per_cpu_second.max, 1e-3 * aim_rays(s.resources),
                       s.rays_per_cpu_second.median / Peers::kArchesRays, 1e-6 * s.hops_per_cpu_second.median,
                       static_cast<double>(s.hops) / static_cast<double>(s.rays), 1e-3 * s.rays_per_wall_second.median);
  out += "\n| memory alone | M requests per CPU-second | cycles a request |\n|---|---:|---:|\n";
  for (const MemorySpeed& m : r.memory)
    out += fmt::format("| {} | {:.2f} ({:.2f} to {:.2f}) | {:.1f} |\n", m.name, 1e-6 * m.requests_per_cpu_second.median,
                       1e-6 * m.requests_per_cpu_second.min, 1e-6 * m.requests_per_cpu_second.max,
                       static_cast<double>(m.cycles) / static_cast<double>(m.requests));
  return out;
}

}  // namespace carousel::bench
