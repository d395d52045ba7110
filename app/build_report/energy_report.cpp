#include "app/build_report/energy_report.h"

#include <algorithm>
#include <string_view>

#include "app/area/machine_area.h"
#include "app/energy/energy_account.h"
#include "core/config/costs.h"
#include "core/config/write.h"
#include "report/text/ratio.h"

namespace carousel::app {

using report::ratio;

namespace {

std::vector<report::CostConstant> constants(const Config& config) {
  static constexpr std::string_view kBases[] = {"published", "derived", "assumed"};
  std::vector<report::CostConstant> out;
  for (const CostRow& row : kCostTable) {
    const CostValue value = cost_value(config, row.cost);
    const bool given = value.source == "the configuration";
    out.push_back({std::string(row.section) + "." + std::string(row.key), row.unit,
                   std::string(given ? "given" : kBases[static_cast<std::size_t>(value.basis)]),
                   std::string(value.source), shortest(value.value)});
  }
  return out;
}

}  // namespace

void add_sampled_energy(report::Report& r, const Config& config) {
  if (!r.sampled || !r.energy) return;
  report::Sampled& s = *r.sampled;
  double moved = 0;
  for (const ByteRow& row : *r.bytes)
    if (row.what == "lines" || row.what == "written lines") moved += static_cast<double>(row.bytes);
  const double rays = static_cast<double>(r.rays.completed), link_mm = r.area->link_mm;
  const EnergyAccount account(config, link_mm, *r.bytes);
  const ringbus::EnergyEvents events = energy_events(r);
  const auto with = [&](double bytes_per_ray) {
    const double times = moved > 0 ? bytes_per_ray * rays / moved : 1;
    return ratio(joules_of(account.parts(events, times)), rays) * 1e9;
  };
  const auto unsure = [](const report::SampledValue& v) { return ratio(v.high - v.low, 2 * v.estimate); };
  const double error =
      with(0) * std::max({unsure(s.box_tests_per_ray), unsure(s.triangle_tests_per_ray), unsure(s.link_bytes_per_ray)});
  const report::SampledValue& bytes = s.memory_bytes_per_ray;
  report::SampledEnergy& energy = s.nj_per_ray.emplace();
  energy.estimate = with(bytes.estimate);
  energy.low = std::max(0.0, with(bytes.low) - error);
  energy.high = with(bytes.high) + error;
}

void add_energy(report::Report& r, const Config& config, const SceneFacts& scene) {
  if (config.energy.profile == CostProfile::kNone || !r.engine.cycles || !r.bytes || !r.memory || !r.resources) return;
  report::Area area = machine_area(config, scene);
  report::Energy& energy = r.energy.emplace();
  energy.profile = enum_name(config.energy.profile);
  energy.parts = EnergyAccount(config, area.link_mm, *r.bytes).parts(energy_events(r));
  energy.parts.share_among(static_cast<double>(r.rays.completed));
  energy.joules = joules_of(energy.parts);
  const double rays = static_cast<double>(r.rays.completed);
  const double seconds = static_cast<double>(*r.engine.cycles) / (static_cast<double>(config.engine.clock_mhz) * 1e6);
  energy.nj_per_ray = ratio(energy.joules, rays) * 1e9;
  energy.watts = ratio(energy.joules, seconds);
  energy.rays_per_joule = ratio(rays, energy.joules);
  area.mrays_per_second_per_mm2 = ratio(ratio(rays, seconds) * 1e-6, area.mm2);
  r.area = std::move(area);
  r.costs = constants(config);
}

}  // namespace carousel::app
