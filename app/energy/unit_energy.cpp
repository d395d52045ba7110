#include "app/energy/unit_energy.h"

#include "core/config/shader_programs.h"
#include "ringbus/cycle/messages/memory_messages.h"

namespace carousel::app {

/// An L2 is read or written for each line that the unit asks for or writes, for each that comes from the memory, and
/// for each that it keeps and sends there later. Its walker reads past it, and a page is a word of its TLB.
double unit_joules(const Costs& costs, const MemoryConfig& memory, const ringbus::cycle::BuilderUse& use,
                   double store_kib, std::uint64_t record_bytes, double tests_pj) {
  const std::uint64_t line_bytes = ringbus::cycle::fetched_bytes(memory);
  const std::uint64_t moved = (use.memory.lines + use.memory.lines_written) * line_bytes,
                      bytes = (use.lines_read + use.lines_written) * line_bytes;
  const bool hbm = memory.dram.preset == DramConfig::Preset::kHbm2;
  double pj = static_cast<double>(moved) * costs.of(hbm ? Cost::kHbm : Cost::kDram) + tests_pj +
              static_cast<double>(bytes + record_bytes) / 8 * costs.sram_access_pj(store_kib);
  if (use.l2) {
    const std::uint64_t own = use.memory.lines - use.l2->walk_reads + use.l2->written_back + use.l2->drained;
    pj += static_cast<double>(bytes + own * line_bytes) / 8 *
          costs.sram_access_pj(static_cast<double>(memory.l2_kib) / static_cast<double>(memory.l2_banks));
    if (use.l2->pages > 0)
      pj += static_cast<double>(use.l2->pages + use.l2->walks) *
            costs.sram_access_pj(static_cast<double>(memory.translation.entries * kTlbEntryBytes) / 1024);
  }
  if (use.dram)
    for (const ringbus::DramUse::Channel& channel : use.dram->channels)
      pj += static_cast<double>(channel.counts.row_misses + channel.counts.row_conflicts) *
            costs.of(hbm ? Cost::kHbmActivation : Cost::kDramActivation);
  return pj * 1e-12;
}

}  // namespace carousel::app
