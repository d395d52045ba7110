#include "app/frames/frame_builder.h"

#include <algorithm>
#include <limits>

#include "app/area/machine_area.h"
#include "core/config/costs.h"
#include "ringbus/cycle/builder/builder_unit.h"
#include "ringbus/cycle/builder/builder_work.h"
#include "ringbus/cycle/messages/memory_messages.h"
#include "ringbus/cycle/shapes/shape_memory.h"

namespace carousel::app {

namespace {

using ringbus::cycle::BuilderUse;
using ringbus::cycle::BuilderWork;
using ringbus::cycle::ShapeMemory;

BuilderUse run(const Prepared& p, const BuilderWork& work, const std::stop_token& stop) {
  const Config& c = p.config();
  return ringbus::cycle::run_builder(c.frames->builder, c.memory, c.engine.clock_mhz, work, stop);
}

BuilderWork rebuild_of(const Prepared& p, const accel::Accel& accel, const ShapeMemory& memory,
                       const accel::ChangedParts& parts) {
  return ringbus::cycle::rebuild_work(accel, memory, parts,
                                      static_cast<std::uint64_t>(p.config().frames->builder.local_primitives));
}

/// The lines that the work writes, in ascending order, each once.
std::vector<std::uint64_t> written_lines(const BuilderWork& work, std::uint64_t line_bytes) {
  std::vector<std::uint64_t> out;
  for (const auto& level : work.levels)
    for (const ringbus::cycle::BuilderTask& task : level)
      for (const ringbus::cycle::ShapeSpan& span : task.writes)
        for (std::uint64_t line = span.address / line_bytes; line * line_bytes < span.address + span.bytes; ++line)
          out.push_back(line);
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

template <class Drop>
std::uint64_t drop_lines(std::vector<std::vector<std::uint64_t>>& cached, const Drop& is_dropped) {
  std::uint64_t dropped = 0;
  for (std::vector<std::uint64_t>& lines : cached) dropped += std::erase_if(lines, is_dropped);
  return dropped;
}

/// A box that is added to others costs what a test of one does: as many comparisons. Lines pass the builder's store,
/// and each box is read there.
std::optional<double> joules_of(const Config& config, const BuilderUse& use, std::uint64_t bytes) {
  if (config.energy.profile == CostProfile::kNone) return std::nullopt;
  const Costs costs = costs_of(config);
  const bool hbm = config.memory.dram.preset == DramConfig::Preset::kHbm2;
  double pj = static_cast<double>(bytes) * costs.of(hbm ? Cost::kHbm : Cost::kDram) +
              static_cast<double>(use.boxes) * costs.of(energy_of(UnitKind::kBox)) +
              static_cast<double>(bytes + use.boxes * BuilderConfig::kRecordBytes) / 8 *
                  costs.sram_access_pj(builder_kib(config));
  if (use.dram)
    for (const ringbus::DramUse::Channel& channel : use.dram->channels)
      pj += static_cast<double>(channel.counts.row_misses + channel.counts.row_conflicts) *
            costs.of(hbm ? Cost::kHbmActivation : Cost::kDramActivation);
  return pj * 1e-12;
}

}  // namespace

BuilderFrame build_in_machine(const Prepared& p, const accel::ChangedParts& parts, bool refit,
                              const std::stop_token& stop, std::vector<std::vector<std::uint64_t>>& cached) {
  const Config& c = p.config();
  const ShapeMemory memory(p.accel, c.accuracy, c.bvh, c.memory);
  const BuilderWork work =
      refit ? ringbus::cycle::refit_work(p.accel, memory, parts) : rebuild_of(p, p.accel, memory, parts);
  const BuilderUse use = run(p, work, stop);
  const std::uint64_t line_bytes = ringbus::cycle::fetched_bytes(c.memory);
  BuilderFrame out;
  out.complete = use.complete;
  out.cost = {.cycles = use.cycles,
              .levels = use.levels,
              .boxes = use.boxes,
              .bytes_read = use.lines_read * line_bytes,
              .bytes_written = use.lines_written * line_bytes,
              .top_bytes = use.top_lines * line_bytes};
  out.cost.joules = joules_of(c, use, out.cost.bytes_read + out.cost.bytes_written);
  if (use.levels == 0) return out;
  if (refit) {
    const std::vector<std::uint64_t> written = written_lines(work, line_bytes);
    out.cost.lines_dropped = drop_lines(
        cached, [&](std::uint64_t line) { return std::binary_search(written.begin(), written.end(), line); });
  } else {
    out.cost.lines_dropped = drop_lines(cached, [](std::uint64_t) { return true; });
  }
  return out;
}

std::uint64_t rebuild_cycles(const Prepared& p, const accel::Accel& rebuilt, const accel::ChangedParts& parts,
                             const std::stop_token& stop) {
  const Config& c = p.config();
  const ShapeMemory memory(rebuilt, c.accuracy, c.bvh, c.memory);
  return run(p, rebuild_of(p, rebuilt, memory, parts), stop).cycles;
}

}  // namespace carousel::app
