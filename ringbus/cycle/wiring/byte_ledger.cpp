#include "ringbus/cycle/wiring/byte_ledger.h"

#include <fmt/format.h>

#include "core/system/error.h"
#include "ringbus/cycle/shapes/shape_buffer.h"

namespace carousel::ringbus::cycle {

std::vector<ByteRow> byte_ledger(const SimulatedMachine& machine) {
  std::vector<ByteRow> rows = machine.channels().rows();
  const MachineKinds& kinds = machine.kinds();
  machine.memory().count_written(rows[ChannelList::index(kinds.memory.written)]);
  if (kinds.distributor) kinds.distributor->count(rows, *machine.resources().front()->result().distributor);
  return rows;
}

void check_byte_ledger(const std::vector<ByteRow>& rows) {
  for (const ByteRow& row : rows)
    if (row.bytes != row.bytes_taken + row.bytes_waiting)
      throw SimulationError(fmt::format("{}: {} sent {} bytes, {} took {}, and {} are under way", row.what, row.from,
                                        row.bytes, row.to, row.bytes_taken, row.bytes_waiting));
}

void check_lines(const SimulatedMachine& machine, const std::vector<ByteRow>& rows, const MemoryConfig& memory) {
  const auto check = [&](std::string_view what, std::uint64_t lines, std::uint64_t bytes) {
    if (lines * fetched_bytes(memory) != bytes)
      throw SimulationError(fmt::format("{} {} lines, but {} bytes of lines were sent", what, lines, bytes));
  };
  const MachineKinds& kinds = machine.kinds();
  const bool own = !machine.memory().own_caches().empty();
  const std::uint64_t shapes = rows[ChannelList::index(kinds.side.fetch.data)].bytes;
  const std::uint64_t ray_data = kinds.ray_data ? rows[ChannelList::index(kinds.ray_data->data)].bytes : 0;
  std::uint64_t looked_up = 0, asked = 0;
  for (const auto& cache : own ? machine.memory().own_caches() : machine.memory().caches())
    looked_up += cache->statistics().lines - cache->statistics().past_end;  // nobody gets those past the end
  for (const auto& resource : machine.resources()) asked += resource->shape_buffer().port().lines();
  // An L2 answers resources, and ray control and shading; a resource's own cache has one client.
  check("caches looked up", looked_up, own ? shapes : shapes + ray_data);
  check("resources asked for", asked, shapes);
  if (kinds.ray_data) check("shading asked for", machine.shading().ray_data()->lines(), ray_data);
}

}  // namespace carousel::ringbus::cycle
