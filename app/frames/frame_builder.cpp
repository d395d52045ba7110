#include "app/frames/frame_builder.h"

#include <algorithm>
#include <cstddef>
#include <utility>

#include "app/area/machine_area.h"
#include "app/energy/unit_energy.h"
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

BuilderUse run(const Prepared& p, const BuilderWork& work, const std::stop_token& stop,
               std::vector<std::uint64_t>& cached) {
  const Config& c = p.config();
  return ringbus::cycle::run_builder(c.frames->builder, c.memory, c.engine.clock_mhz, work, stop, cached);
}

BuilderWork rebuild_of(const Prepared& p, const accel::Accel& accel, const ShapeMemory& memory,
                       const accel::ChangedParts& parts) {
  return ringbus::cycle::rebuild_work(accel, memory, parts,
                                      static_cast<std::uint64_t>(p.config().frames->builder.local_primitives));
}

void add_lines(const ringbus::cycle::ShapeSpan& span, std::uint64_t line_bytes, std::vector<std::uint64_t>& out) {
  for (std::uint64_t line = span.address / line_bytes; line * line_bytes < span.address + span.bytes; ++line)
    out.push_back(line);
}

/// The lines that the work writes, in ascending order.
std::vector<std::uint64_t> written_lines(const BuilderWork& work, std::uint64_t line_bytes) {
  std::vector<std::uint64_t> out;
  for (const auto& level : work.levels)
    for (const ringbus::cycle::BuilderTask& task : level)
      for (const ringbus::cycle::ShapeSpan& span : task.writes) add_lines(span, line_bytes, out);
  std::sort(out.begin(), out.end());
  return out;
}

/// The lines that others have written before it, in ascending order.
std::vector<std::uint64_t> moved_lines(const BuilderWork& work, std::uint64_t line_bytes) {
  std::vector<std::uint64_t> out;
  for (const ringbus::cycle::ShapeSpan& span : work.moved) add_lines(span, line_bytes, out);
  std::sort(out.begin(), out.end());
  return out;
}

/// These lines, in ascending order, leave the caches from number `first` on.
std::uint64_t drop_lines(std::vector<std::vector<std::uint64_t>>& cached, std::size_t first,
                         const std::vector<std::uint64_t>& dropped) {
  std::uint64_t count = 0;
  for (std::size_t c = first; c < cached.size(); ++c)
    count += std::erase_if(
        cached[c], [&](std::uint64_t line) { return std::binary_search(dropped.begin(), dropped.end(), line); });
  return count;
}

std::uint64_t drop_all(std::vector<std::vector<std::uint64_t>>& cached) {
  std::uint64_t count = 0;
  for (std::vector<std::uint64_t>& lines : cached) count += std::exchange(lines, {}).size();
  return count;
}

/// A box that is added to others costs what a test of one does: as many comparisons. Lines pass the builder's store,
/// and each box is read there.
std::optional<double> joules_of(const Config& config, const BuilderUse& use) {
  if (config.energy.profile == CostProfile::kNone) return std::nullopt;
  const Costs costs = costs_of(config);
  return unit_joules(costs, config.memory, use, builder_kib(config), use.boxes * BuilderConfig::kRecordBytes,
                     static_cast<double>(use.boxes) * costs.of(energy_of(UnitKind::kBox)));
}

report::FrameUpdateCost cost_of(const Config& config, const BuilderUse& use) {
  const std::uint64_t line_bytes = ringbus::cycle::fetched_bytes(config.memory);
  report::FrameUpdateCost out{.cycles = use.cycles,
                              .levels = use.levels,
                              .boxes = use.boxes,
                              .bytes_read = use.memory.lines * line_bytes,
                              .bytes_written = use.memory.lines_written * line_bytes,
                              .top_bytes = use.top_lines * line_bytes,
                              .joules = joules_of(config, use)};
  if (use.l2)
    out.l2 =
        report::FrameUpdateL2{use.lines_read, use.l2->hits, use.lines_written, use.l2->write_fetches, use.l2->drained};
  return out;
}

}  // namespace

BuilderFrame build_in_machine(const Prepared& p, const accel::ChangedParts& parts, FrameUpdate update,
                              const DoneClusters* done, const std::stop_token& stop,
                              std::vector<std::vector<std::uint64_t>>& cached) {
  const Config& c = p.config();
  const ShapeMemory memory(p.accel, c.accuracy, c.bvh, c.memory);
  const bool anew = update == FrameUpdate::kRebuild;
  const BuilderWork work =
      done != nullptr ? ringbus::cycle::cluster_work(p.accel, memory, parts, done->clusters, done->work,
                                                     static_cast<std::uint64_t>(c.frames->builder.local_primitives))
      : anew          ? rebuild_of(p, p.accel, memory, parts)
                      : ringbus::cycle::refit_work(p.accel, memory, parts);
  const std::uint64_t line_bytes = ringbus::cycle::fetched_bytes(c.memory);
  if (cached.empty()) cached.emplace_back();
  BuilderFrame out;
  const std::uint64_t stale =
      anew && !work.levels.empty() ? drop_all(cached) : drop_lines(cached, 0, moved_lines(work, line_bytes));
  const BuilderUse use = run(p, work, stop, cached.front());
  out.complete = use.complete;
  out.cost = cost_of(c, use);
  const bool asks_l2 = c.frames->builder.asks == BuilderConfig::Asks::kL2;
  out.cost.lines_dropped = stale + drop_lines(cached, asks_l2 ? 1 : 0, written_lines(work, line_bytes));
  return out;
}

report::FrameUpdateCost rebuild_cost(const Prepared& p, const accel::Accel& rebuilt, const accel::ChangedParts& parts,
                                     const std::stop_token& stop) {
  const Config& c = p.config();
  const ShapeMemory memory(rebuilt, c.accuracy, c.bvh, c.memory);
  std::vector<std::uint64_t> cached;
  return cost_of(c, run(p, rebuild_of(p, rebuilt, memory, parts), stop, cached));
}

}  // namespace carousel::app
