#include "ringbus/cycle/wiring/byte_ledger.h"

#include <fmt/format.h>

#include "core/system/error.h"

namespace carousel::ringbus::cycle {

namespace {

template <class T, bool Returns>
void add(ByteRow& row, const Channel<T, Returns>& channel) {
  const auto bytes = channel.bytes();
  row.bytes += bytes.sent;
  row.bytes_taken += bytes.taken;
  row.bytes_waiting += bytes.waiting;
  row.messages += channel.messages().sent;
}

/// Adds messages that are all of one size.
template <class T>
void add(ByteRow& row, const Channel<T>& channel, std::uint64_t bytes_each) {
  const auto messages = channel.messages();
  row.bytes += bytes_each * messages.sent;
  row.bytes_taken += bytes_each * messages.taken;
  row.bytes_waiting += bytes_each * messages.waiting;
  row.messages += messages.sent;
}

ByteRow packets(const SimulatedMachine& machine, std::uint64_t width) {
  ByteRow row{"packets", "resources", "neighbours", "links", width};
  for (std::size_t i = 0; i < machine.shared().topology.wires().size(); ++i)
    add(row, machine.network().wire(i).packets);
  return row;
}

/// The resources count the lines for which they ask, the caches those that they look up.
ByteRow shape_data(const SimulatedMachine& machine, const MemoryConfig& memory) {
  const std::uint64_t line = fetched_bytes(memory);
  const bool own = !machine.memory().own_caches().empty();
  ByteRow row{
      "shape data", own ? "L1" : "L2", "resources", own ? "L1's port" : "L2's port",
      line * static_cast<std::uint64_t>(own ? memory.l1_lines_per_cycle : memory.l2_lines_per_cycle * memory.l2_banks)};
  for (const auto& cache : own ? machine.memory().own_caches() : machine.memory().caches())
    row.bytes += (cache->statistics().lines - cache->statistics().past_end) * line;  // nobody gets those past the end
  for (const auto& channels : machine.channels()) {
    const SidePorts side = channels->ports();
    row.messages += side.fetched->messages().sent;
  }
  for (const auto& resource : machine.resources()) row.bytes_taken += resource->lines_asked() * line;
  if (own || machine.shading().ray_data() == nullptr) return row;
  // An L2 answers resources, and ray control and shading, by the same ports; ray_data() has the others.
  row.bytes -= machine.shading().ray_data()->lines() * line;
  return row;
}

/// Lines of rays and paths that ray control and shading have read.
ByteRow ray_data(const SimulatedMachine& machine, const MemoryConfig& memory) {
  const std::uint64_t line = fetched_bytes(memory);
  ByteRow row{"ray data", "L2", "shading", "L2's port",
              line * static_cast<std::uint64_t>(memory.l2_lines_per_cycle * memory.l2_banks)};
  row.bytes = row.bytes_taken = machine.shading().ray_data()->lines() * line;
  for (const auto& channels : machine.ray_data()) row.messages += channels->ports().fetched->messages().sent;
  return row;
}

/// Adds the traffic from the distributor to its testers, and from them to the decision point.
void add_distributor(std::vector<ByteRow>& rows, const SimulatedMachine& machine, const Config& config) {
  constexpr std::uint64_t kId = 4, kMask = 1, kNext = 12;
  const std::uint64_t result = kId + (config.collections.traversal == Traversal::kOrdered ? kNext : kMask);
  const TestersConfig::Distributor& of = config.testers.distributor;
  const DistributorCounts counts = *machine.resources().front()->result().distributor;
  ByteRow ids{"ray IDs", "distributor", "testers", "wires of IDs", kId * static_cast<std::uint64_t>(of.ids_per_cycle)};
  ByteRow shapes{"shapes", "distributor", "testers", "bus of shapes",
                 static_cast<std::uint64_t>(config.topology.link.bytes_per_cycle)};
  ByteRow results{"results", "testers", "decision point", "wires of results",
                  result * static_cast<std::uint64_t>(of.results_per_cycle)};
  ids.messages = results.messages = counts.ids;
  ids.bytes = kId * counts.ids;
  ids.bytes_taken = kId * counts.results;
  shapes.messages = counts.packets;
  shapes.bytes = shapes.bytes_taken = counts.shape_bytes;
  results.bytes = result * counts.ids;
  results.bytes_taken = result * counts.results;
  rows.insert(rows.end(), {ids, shapes, results});
}

}  // namespace

std::vector<ByteRow> byte_ledger(const SimulatedMachine& machine, const Config& config) {
  const auto width = static_cast<std::uint64_t>(config.topology.link.bytes_per_cycle);
  const std::uint64_t line = fetched_bytes(config.memory);
  const auto lines_per_cycle = static_cast<std::uint64_t>(config.memory.l2_lines_per_cycle * config.memory.l2_banks);
  constexpr std::uint64_t kAddress = 8;
  ByteRow new_rays{"new rays", "ray control", "resources", "load ports and wires of IDs", width};
  ByteRow completed{"completed rays", "resources", "ray control", "ports of completed rays", width};
  ByteRow requests{"shape requests", "resources", "L2", "request wires", width};
  ByteRow questions{"any-hit questions", "resources", "shading", "wires of questions", width};
  ByteRow answers{"any-hit answers", "shading", "resources", "wires of answers", width};
  ByteRow jobs{"shading jobs", "shading", "resources", "wires of jobs", width};
  ByteRow notes{"notes and results", "resources", "shading", "wires of notes", width};
  ByteRow addresses{"line requests", "L2", "DRAM", "address wires", kAddress * lines_per_cycle};
  ByteRow lines{"lines", "DRAM", "L2", "DRAM's data wires",
                static_cast<std::uint64_t>(machine.memory().memory().peak_bytes_per_cycle())};
  for (const auto& channels : machine.channels()) {
    const SidePorts side = channels->ports();
    add(new_rays, *side.new_rays);
    add(completed, *side.completed);
    add(requests, *side.fetch);
    if (side.questions != nullptr) add(questions, *side.questions);
    if (side.answers != nullptr) add(answers, *side.answers);
    if (side.jobs != nullptr) add(jobs, *side.jobs);
    if (side.help != nullptr) add(notes, *side.help);
  }
  machine.memory().for_each_channel([&](const Channel<std::uint64_t>& down, const Channel<std::uint64_t>& up) {
    add(addresses, down, kAddress);
    add(lines, up, line);
  });
  const auto own_lines = static_cast<std::uint64_t>(config.memory.l1_lines_per_cycle);
  ByteRow own_addresses{"line requests of L1", "L1", "L2", "address wires", kAddress * own_lines};
  ByteRow own_data{"lines for L1", "L2", "L1", "L2's port", line * lines_per_cycle};
  machine.memory().for_each_own_channel([&](const Channel<std::uint64_t>& down, const Channel<std::uint64_t>& up) {
    add(own_addresses, down, kAddress);
    add(own_data, up, line);
  });
  // Entries that do not fit collection storage, and data of rays and paths: to L2 with their requests, and on to DRAM
  // in whole lines.
  ByteRow spilled{"written lines", "L2", "DRAM", "DRAM's data wires", lines.width};
  for (const auto& cache : machine.memory().caches())
    spilled.bytes +=
        (cache->statistics().written + cache->statistics().written_back + cache->statistics().drained) * line;
  spilled.bytes_taken = machine.memory().memory().lines_written() * line;
  spilled.messages = spilled.bytes / line;  // "line requests" has counted these messages
  std::vector<ByteRow> rows{packets(machine, width),
                            new_rays,
                            completed,
                            requests,
                            shape_data(machine, config.memory),
                            addresses,
                            lines,
                            spilled,
                            questions,
                            answers,
                            jobs,
                            notes};
  if (machine.shading().ray_data() != nullptr) {
    ByteRow asked{"requests of ray data", "shading", "L2", "request wires", width};
    for (const auto& channels : machine.ray_data()) add(asked, *channels->ports().fetch);
    rows.insert(rows.end(), {asked, ray_data(machine, config.memory)});
  }
  if (config.memory.fetch == MemoryConfig::Fetch::kMulticast) {
    ByteRow pushed{"multicast shapes", "L2", "resources", "wires of answers",
                   static_cast<std::uint64_t>(config.memory.l2_answer_bytes_per_cycle)};
    for (const auto& channels : machine.channels()) add(pushed, *channels->ports().pushed);
    rows.push_back(pushed);
  }
  if (has_distributor(config)) add_distributor(rows, machine, config);
  if (!machine.memory().own_caches().empty()) rows.insert(rows.end(), {own_addresses, own_data});
  return rows;
}

void check_byte_ledger(const std::vector<ByteRow>& rows) {
  for (const ByteRow& row : rows)
    if (row.bytes != row.bytes_taken + row.bytes_waiting)
      throw SimulationError(fmt::format("{}: {} sent {} bytes, {} took {}, and {} are under way", row.what, row.from,
                                        row.bytes, row.to, row.bytes_taken, row.bytes_waiting));
}

}  // namespace carousel::ringbus::cycle
