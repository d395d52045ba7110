#include "ringbus/cycle/wiring/machine_energy.h"

namespace carousel::ringbus::cycle {

namespace {

/// In the order of CycleResult::links: those of packets, which may carry parcels as well, then those of parcels alone,
/// then those of rings with stops.
void read_links(const SimulatedMachine& machine, std::vector<std::uint64_t>& bytes) {
  bytes.clear();
  const std::size_t wires = machine.shared().topology.wires().size();
  for (std::size_t i = 0; i < wires; ++i) bytes.push_back(machine.network().near(i).packets.bytes_sent());
  if (machine.parcels() != nullptr) {
    const ParcelPlan& plan = machine.parcels()->plan();
    for (std::size_t i = 0; i < plan.links.size(); ++i) {
      const std::uint64_t own = machine.parcels()->time_of(i).bytes();
      if (plan.links[i].wire == ParcelPlan::kNone)
        bytes.push_back(own);
      else
        bytes[plan.links[i].wire] += own;
    }
  }
  for (const RingHub* ring : machine.network().rings())
    ring->for_each_link([&](const config::Graph::Link& drawn, const RingLinks::Use& use) {
      bytes.push_back(use.busy * static_cast<std::uint64_t>(drawn.bytes_per_cycle));
    });
}

void read_messages(const SimulatedMachine& machine, const std::optional<DistributorCounts>& distributor,
                   std::vector<std::uint64_t>& bytes) {
  const MachineKinds& kinds = machine.kinds();
  machine.channels().bytes_sent(bytes);
  ByteRow written;
  machine.memory().count_written(written);
  bytes[ChannelList::index(kinds.memory.written)] = written.bytes;
  if (!kinds.distributor || !distributor) return;
  std::vector<ByteRow> rows(bytes.size());
  kinds.distributor->count(rows, *distributor);
  for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] += rows[i].bytes;
}

}  // namespace

void read_energy(const SimulatedMachine& machine, EnergyEvents& events) {
  events.resources.clear();
  std::optional<DistributorCounts> distributor;
  for (const auto& resource : machine.resources()) {
    ResourceAgent::Work work = resource->work();
    if (const NearestRays* const nearest = machine.shared().stores[events.resources.size()]->nearest()) {
      work.energy.buffer_bytes = nearest->use().counts.moved_bytes();
      work.energy.color_terms = nearest->use().counts.color_terms;
    }
    events.resources.push_back(work.energy);
    if (!distributor && work.distributor != nullptr) distributor = *work.distributor;
  }
  read_links(machine, events.link_bytes);
  read_messages(machine, distributor, events.row_bytes);
  events.l2_lines = events.asked_ahead = events.l1_lines = events.l2_pages = 0;
  for (const auto& cache : machine.memory().caches()) {
    events.l2_lines += cache->statistics().lines;
    events.asked_ahead += cache->ahead().asked;
    events.l2_pages += cache->statistics().pages + cache->statistics().walks;
  }
  for (const auto& cache : machine.memory().own_caches()) events.l1_lines += cache->statistics().lines;
  events.parts = machine.parts().counts();
  const ShadingCounts shading = machine.shading().counts();
  events.shaded = machine.shading().completed();
  events.products = shading.products;
  events.lookups = shading.lookups;
  events.programs = shading.programs;
  events.shade_data = shading.data;
  events.activations = 0;
  for (const auto& memory : machine.memory().memories()) events.activations += memory->activations();
}

}  // namespace carousel::ringbus::cycle
