#include "ringbus/cycle/wiring/simulated_machine.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "core/config/own_sections.h"
#include "core/config/shader_programs.h"
#include "core/system/error.h"
#include "ringbus/cycle/tile/independent_tile.h"
#include "ringbus/cycle/tile/tile.h"
#include "ringbus/cycle/tile/warps/warp_tile.h"
#include "ringbus/time/wait_cycle.h"

namespace carousel::ringbus::cycle {

namespace {

/// Packets that are tested where they are issued need no flow control: one for each context, and those whose shapes are
/// being fetched. Where new rays travel in them, they are as many as in other networks.
std::optional<std::uint32_t> local_packets(const Config& config) {
  const Placement placement = config.rays.placement;
  if (config.topology.resources > 1 && (placement == Placement::kFirstTaker || placement == Placement::kAddressed))
    return std::nullopt;
  return static_cast<std::uint32_t>(most_of_resources(
      config, [](const OwnSections& one) { return one.testers.contexts + 1 + one.memory.fetch_ahead; }));
}

/// The resources and hubs have the topology's numbers.
AgentNumbers agent_numbers(const Topology& topology, const MemoryConfig& memory, const ParcelPlan& plan) {
  const auto resources = static_cast<std::uint32_t>(topology.resources());
  AgentNumbers out{resources + static_cast<std::uint32_t>(topology.hubs().size()),
                   static_cast<std::uint32_t>(MemorySystem::shared_caches(memory, resources)),
                   memory.l1_kib > 0 ? resources : 0, static_cast<std::uint32_t>(memory.shared_by)};
  if (!plan.any()) return out;
  const config::DrawnParts& parts = plan.parts;
  out.relays = static_cast<std::uint32_t>(plan.graph.nodes.size());
  out.shared_links = static_cast<std::uint32_t>(
      std::ranges::count_if(plan.links, [](const ParcelPlan::Link& link) { return link.wire != ParcelPlan::kNone; }));
  if (!parts.caches.empty()) {
    out.caches_drawn = true;
    out.caches = static_cast<std::uint32_t>(parts.cache_nodes());
    out.first_cache_node = parts.caches.front().nodes.front();
  }
  if (!parts.memories.nodes.empty()) {
    out.memories_drawn = true;
    out.memories = static_cast<std::uint32_t>(parts.memories.nodes.size());
  }
  out.new_rays_drawn = parts.new_rays;
  out.completed_drawn = parts.completed_rays;
  for (std::uint32_t r = 0; !parts.pools.empty() && r < resources; ++r) out.pool_nodes.push_back(parts.pool_node(r));
  return out;
}

/// With all by which parts of the machine go.
MachineClocks machine_clocks(const Config& config) {
  MachineClocks out(config.engine.clock_mhz, config.clocks.synchroniser_cycles);
  out.use(0);
  for (const GraphNode& node : config.topology.nodes) out.use(node.mhz);
  for (const GraphLink& link : config.topology.links) out.use(link.mhz);
  return out;
}

/// Programs read surfaces while they run, and Gaussians have none.
bool keeps_surfaces(const Config& config, const accel::Accel& accel) {
  return config.memory.surfaces == MemoryConfig::ShadingData::kMemory && !config.shading.program.any() &&
         config.workload.kind == WorkloadConfig::Kind::kRays && accel.gaussians == nullptr;
}

bool reads_first_hits(const Config& config) {
  return config.primary == Primary::kRaster && config.raster.time == RasterConfig::Time::kCycles;
}

bool has_ray_data(const Config& config, const accel::Accel& accel) {
  const bool sky_map =
      config.workload.kind == WorkloadConfig::Kind::kRays && config.scene.sky && !config.scene.sky->file.empty();
  return RayData::wanted(config.memory, sky_map) || keeps_surfaces(config, accel) || config.shading.program.any() ||
         reads_first_hits(config);
}

/// Of each pool. `pool_of`: by resource, where there are several.
std::vector<ShadingSettings> shading_settings(const Config& config, const std::vector<std::size_t>& pool_of) {
  std::shared_ptr<const ShadePrograms> programs;
  if (config.shading.program.any())
    programs = std::make_shared<const ShadePrograms>(shade_programs(config.shading, config.programs, config.testers));
  const std::size_t vectors = programs ? vectors_held(config.shading, *programs) : 1;
  std::vector<ShadingSettings> out;
  for (const std::int64_t workers : pool_workers(config))
    out.push_back({config.shading, config.bundles, config.topology.link, config.faults.resource,
                   static_cast<std::size_t>(workers), static_cast<std::size_t>(all_slots(config)),
                   static_cast<std::size_t>(config.packets.rays), static_cast<std::uint64_t>(config.image.seed),
                   programs, vectors, config.rays.placement == Placement::kAddressed});
  if (pool_of.empty()) return out;
  for (ShadingSettings& of : out) of.slots = 0;
  for (std::size_t r = 0; r < pool_of.size(); ++r)
    out[pool_of[r]].slots +=
        static_cast<std::size_t>(own_sections(config, static_cast<std::int64_t>(r)).rays.slots_per_resource);
  return out;
}

/// Packets that a resource may have in test at once, by resource.
std::vector<std::int64_t> contexts_of(const Config& config) {
  std::vector<std::int64_t> out;
  for (std::int64_t r = 0; r < config.topology.resources; ++r) out.push_back(own_sections(config, r).testers.contexts);
  return out;
}

std::int64_t most_contexts(const Config& config) {
  return most_of_resources(config, [](const OwnSections& one) { return one.testers.contexts; });
}

std::uint32_t most_slots(const Machine& machine) {
  std::uint32_t most = 0;
  for (const auto& store : machine.stores) most = std::max(most, store->slots());
  return most;
}

/// As the resources ask it for shapes, by resource.
std::vector<MemoryConfig> memory_of(const Config& config) {
  std::vector<MemoryConfig> out;
  for (std::int64_t r = 0; r < config.topology.resources; ++r) out.push_back(own_sections(config, r).memory);
  return out;
}

/// Rays in bundles have no packets of their own, and rays that begin anew have two lives. Resources with warps note no
/// stages: a ray there also waits for a warp, for other lanes and for its stack, and RayStage has no names for that.
bool accounts_for_rays(const Config& config, const Observation& observed) {
  return observed.ray_times && config.bundles.size == 0 &&
         most_of_resources(config, [](const OwnSections& one) { return one.testers.simt.warp; }) == 0 &&
         config.faults.resource.kind != FaultsConfig::Resource::Kind::kStop;
}

bool calls_shader(const Config& config, const accel::Accel& accel) {
  return accel.calls_any_hit() && config.testers.any_hit == TestersConfig::AnyHit::kShader;
}

}  // namespace

SimulatedMachine::SimulatedMachine(const Config& config, const accel::Accel& accel, float scene_size,
                                   Workload& workload, bool statistics, const Observation& observed)
    : shared_(config, accel, scene_size, local_packets(config)),
      shape_memory_(accel, config.accuracy, config.bvh, config.memory),
      shape_blocks_(config.collections.key == CollectionKey::kBlock
                        ? std::make_unique<const ShapeBlocks>(
                              accel, shape_memory_, static_cast<std::uint64_t>(config.collections.block_bytes))
                        : nullptr),
      plan_(plan_parcels(config.topology, config.memory.line_bytes)),
      numbers_(agent_numbers(shared_.topology, config.memory, plan_)),
      network_(channels_, shared_, config.topology, config.faults, contexts_of(config), machine_clocks(config),
               ParcelNetwork::shared_wires(plan_, numbers_)),
      kinds_(machine_kinds(channels_, config.topology.link, config.memory, has_ray_data(config, accel),
                           has_distributor(config) ? &config.testers.distributor : nullptr,
                           config.collections.traversal)),
      parts_(channels_, numbers_, config.parts, config.memory, config.topology.link, shared_.topology.resources()) {
  if (plan_.parts.pools.size() > 1) shared_.divide_control(config, scene_size, plan_.parts.pool_of);
  if (plan_.any())
    parcels_ = std::make_unique<ParcelNetwork>(channels_, plan_, numbers_, shared_.topology, network_,
                                               config.topology.link, config.memory);
  const std::vector<MemoryConfig> own_memory = memory_of(config);
  if (observed.timeline.most > 0 || observed.ray != nullptr)
    recorder_ =
        std::make_unique<Recorder>(config.testers, most_contexts(config), has_distributor(config), shared_, observed);
  if (accounts_for_rays(config, observed))
    times_ = std::make_unique<RayTimes>(shared_.topology.resources(), most_slots(shared_), shared_.packets.size(),
                                        workload, observed.heat);
  std::vector<ShadingAgent::Pool> pools;
  for (ShadingSettings& settings : shading_settings(config, shared_.pool_of))
    pools.push_back({std::move(settings), std::vector<SidePorts>(shared_.topology.resources())});
  std::vector<ShapeCache::Client> cache_clients;
  for (std::uint32_t r = 0; r < shared_.topology.resources(); ++r) {
    const ResourceId id(r);
    const SideLatencies latencies(config.topology.link, ShapeCache::nearest(own_memory[r]));
    sides_.push_back(std::make_unique<SideChannels>(channels_, kinds_.side, latencies, numbers_, r,
                                                    config.shading.idle_resources_shade, calls_shader(config, accel)));
    SidePorts side = sides_.back()->ports();
    side.hints = parts_.hints_of(r);
    cache_clients.push_back({side.fetch, side.fetched, side.pushed});
    SidePorts& of_shading = pools[shared_.pools.empty() ? 0 : shared_.pool_of[r]].clients[r];
    of_shading = side;
    if (parcels_) {
      const ParcelNetwork::Sides over_links = parcels_->join(r, side);
      side = over_links.resource;
      of_shading = over_links.shading;
    }
    TileSettings settings = tile_settings(config, id, scene_size, statistics, observed);
    settings.blocks = shape_blocks_.get();
    if (parcels_) settings.way_to_memory = parcels_->way_to_memory(r);
    if (recorder_) settings.recording = recorder_->of_resource(id);
    settings.recording.times = times_.get();
    if (shared_.topology.has_packets()) {
      Network::NodePorts links = network_.ports_at(id);
      record_links(id, [&](std::size_t port, const LinkRecorder& to) { links.out[port].record(to); });
      resources_.push_back(std::make_unique<Tile>(id, shared_, shape_memory_, settings,
                                                  Tile::Ports{side, std::move(links.in), std::move(links.out)}));
    } else if (settings.testers.simt.warp > 0) {
      resources_.push_back(std::make_unique<WarpTile>(id, shared_, shape_memory_, settings, side));
    } else {
      resources_.push_back(std::make_unique<IndependentTile>(id, shared_, shape_memory_, settings, side));
    }
  }
  shading_ = std::make_unique<ShadingAgent>(shared_, workload, observed, std::move(pools));
  Recording recording = recorder_ ? recorder_->of_shading() : Recording{};
  recording.times = times_.get();
  shading_->record(recording);
  std::vector<std::vector<ShapeCache::Client>> others(numbers_.caches);  // by L2
  if (kinds_.ray_data) {
    std::vector<SidePorts> ends;
    for (std::uint32_t c = 0; c < numbers_.caches; ++c) {
      ray_data_.push_back(std::make_unique<RayDataChannels>(channels_, *kinds_.ray_data, config.memory, numbers_, c));
      const SidePorts& end = ends.emplace_back(ray_data_.back()->ports());
      others[c].push_back({end.fetch, end.fetched});
    }
    std::uint32_t records = 0;
    for (const auto& store : shared_.stores)
      records = std::max(records, store->slots() + store->room().loaded + store->room().own);
    const RayData::Settings settings{config.memory, config.topology.link, records, keeps_surfaces(config, accel)};
    shading_->keep_in_memory(std::make_unique<RayData>(settings, workload, ends));
  }
  for (std::uint32_t c = 0; c < numbers_.caches; ++c)
    for (Channel<FetchRequest>* ahead : parts_.ahead_at(c)) others[c].push_back({ahead});
  DrawnAskers askers;
  if (parcels_) askers = parcels_->askers();
  memory_ =
      std::make_unique<MemorySystem>(channels_, kinds_.memory, kinds_.own_caches, numbers_, config.memory, own_memory,
                                     network_.clocks(), cache_clients, others, parcels_ ? &askers : nullptr);
  if (parcels_) {
    parcels_->join(*memory_);
    parcels_->sample(observed.samples);
  }
  if (observed.memory != nullptr && memory_->memories().size() > 1)
    throw SimulationError(
        fmt::format("the requests to {} memories are no single list; expected one memory", memory_->memories().size()));
  for (const auto& memory : memory_->memories()) {
    memory->sample(observed.samples);
    memory->log(observed.memory);
  }
  for (std::uint32_t h = 0; h < network_.hubs().size(); ++h) {
    Hub& hub = *network_.hubs()[h];
    hub.sample(observed.samples);
    const ClockRatio clock = network_.clocks().from_core(shared_.topology.mhz(hub_node(h)));
    record_links(hub_node(h), [&](std::size_t port, LinkRecorder to) {
      to.clock = clock;
      hub.record(port, to);
    });
  }
}

std::vector<std::vector<Agent*>> SimulatedMachine::share_out(std::size_t threads) const {
  threads = std::clamp<std::size_t>(threads, 1, resources_.size());
  const MachineClocks& clocks = network_.clocks();
  std::vector<std::vector<Agent*>> parts(threads);
  const auto share = [&](const auto& agents) {
    for (std::size_t i = 0; i < agents.size(); ++i) parts[i * threads / agents.size()].push_back(agents[i].get());
  };
  share(resources_);
  share(memory_->caches());
  share(memory_->own_caches());
  share(network_.hubs());
  // Each part goes to the thread of its L2.
  for (std::size_t i = 0; i < parts_.agents().size(); ++i)
    parts[i % numbers_.caches * threads / numbers_.caches].push_back(parts_.agents()[i]);
  for (const auto& memory : memory_->memories()) parts.back().push_back(memory.get());
  if (parcels_) {
    share(parcels_->relays());
    if (!parcels_->shared_links().empty()) share(parcels_->shared_links());
  }
  parts.back().push_back(shading_.get());
  for (const std::vector<Agent*>& part : parts)
    for (Agent* agent : part) agent->run_by(clocks.to_fastest(0));
  for (std::uint32_t h = 0; h < network_.hubs().size(); ++h)
    network_.hubs()[h]->run_by(clocks.to_fastest(shared_.topology.mhz(hub_node(h))));
  if (parcels_) parcels_->run_by_clocks();
  const std::vector<std::uint32_t>& memories = plan_.parts.memories.nodes;
  for (std::size_t m = 0; m < memories.size(); ++m)
    memory_->memories()[m]->run_by(clocks.to_fastest(plan_.mhz(memories[m])));
  return parts;
}

void SimulatedMachine::warm(const WarmCaches& from) {
  memory_->warm(from);
  if (from.buffers == nullptr || from.buffers->size() != resources_.size()) return;
  for (std::size_t r = 0; r < resources_.size(); ++r) {
    ShapeBuffer& buffer = resources_[r]->shape_buffer();
    buffer.warm((*from.buffers)[r], from.part);
    // One with more room than that of the run would have more by now; others have used that, too.
    for (std::size_t i = 1; i < resources_.size(); ++i)
      buffer.warm((*from.buffers)[(r + i) % resources_.size()], from.part);
  }
}

void SimulatedMachine::close(Cycle end) const {
  for (const auto& resource : resources_) resource->close(end);
  for (const auto& hub : network_.hubs()) hub->close(end);
  for (const auto& memory : memory_->memories()) memory->close(end);
  if (parcels_) parcels_->close(end);
  shading_->close(end);
}

void SimulatedMachine::connect(WakeupTable& wakeups) const {
  std::vector<const Agent*> agents;  // in the order of AgentNumbers
  const auto add = [&](const auto& some) {
    for (const auto& one : some) agents.push_back(one.get());
  };
  add(resources_);
  add(network_.hubs());
  add(memory_->caches());
  add(memory_->own_caches());
  add(memory_->memories());
  agents.push_back(shading_.get());
  if (parcels_) {
    add(parcels_->relays());
    add(parcels_->shared_links());
  }
  agents.insert(agents.end(), parts_.agents().begin(), parts_.agents().end());
  channels_.connect(wakeups, agents);
}

LinkUse SimulatedMachine::use_of_link(std::size_t number, std::size_t port_number, Cycle end) const {
  const Topology& topology = shared_.topology;
  const Topology::Wire& wire = topology.wires()[number];
  const OutPort& port = out_of(wire.from)[port_number];
  const MachineClocks& clocks = network_.clocks();
  const ClockRatio from = clocks.from_core(topology.mhz(wire.from)), to = clocks.from_core(topology.mhz(wire.to));
  LinkUse out{wire.from.value, wire.to.value, {}, network_.far(number).queue, {}, wire.mhz};
  out.bytes = network_.near(number).packets.bytes().sent;
  out.use = {port.busy(from.to_network(end)), port.stalled()};
  // Rounding must not make more of it than there is, nor a ring's port, which moves packets while others wait in it.
  out.use.busy = std::min(end, from.before(out.use.busy));
  out.use.stalled = std::min(end - out.use.busy, from.before(out.use.stalled));
  out.queue.packet_cycles = to.before(out.queue.packet_cycles);
  return out;
}

std::string SimulatedMachine::describe_waits() const {
  std::string text = shading_->describe();
  const auto add = [&](const Agent& agent) {
    if (const std::string line = agent.describe(); !line.empty()) text += "\n  " + line;
  };
  for (const auto& resource : resources_) add(*resource);
  for (const auto& hub : network_.hubs()) add(*hub);
  for (const Agent* part : parts_.agents()) add(*part);
  std::vector<Wait> waits;
  for_each_link([&](const Topology::Wire& wire, std::size_t port) {
    if (wire.from.value >= resources_.size()) return;
    if (std::string packet = resources_[wire.from.value]->blocked(port); !packet.empty())
      waits.push_back({wire.from.value, wire.to.value, std::move(packet)});
  });
  if (const std::string circle = wait_cycle(waits); !circle.empty()) text += "\n  " + circle;
  return text;
}

}  // namespace carousel::ringbus::cycle
