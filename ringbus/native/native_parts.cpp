#include "ringbus/native/native_parts.h"

#include <algorithm>

#include <fmt/format.h>

#include "core/system/error.h"
#include "ringbus/schedule/schedule.h"

namespace carousel::ringbus {

namespace {

/// Resources that are played here, with other ranks or without.
std::int64_t resources_here(const Config& config, const Transport* transport) {
  if (transport == nullptr) return config.topology.resources;
  return RankShare(transport->rank(), transport->ranks(), config.topology.resources).arc_size();
}

std::int64_t routers_of(const Config& config) {
  if (config.topology.shape != TopologyShape::kGraph) return 0;
  return static_cast<std::int64_t>(Topology(config.topology).hubs().size());
}

}  // namespace

std::size_t NativeParts::most_threads(const Config& config, const RunOptions& options) {
  const std::int64_t resources = resources_here(config, options.transport);
  // Agents of a schedule share one thread, so that each resource and each worker may be one.
  const std::int64_t workers = shader_workers(config), agents = resources + routers_of(config) + workers;
  const std::int64_t most = Schedule::current() == nullptr ? std::max(resources, workers) : agents;
  return std::clamp<std::size_t>(options.threads, 1, static_cast<std::size_t>(most));
}

NativeParts::NativeParts(const Config& config, const accel::Accel& accel, float scene_size, Workload& workload,
                         const RunOptions& options, const LinkMaker& own_links, std::size_t threads)
    : config_(config),
      accel_(accel),
      scene_size_(scene_size),
      workload_(workload),
      options_(options),
      own_links_(own_links),
      threads_(threads) {
  for (std::int64_t r = 0; r < config.topology.resources; ++r)
    sinks_.push_back(options.statistics ? std::make_unique<StatisticsSink>() : nullptr);
  if (config.faults.resource.kind == FaultsConfig::Resource::Kind::kStop) ledger_ = std::make_unique<OutstandingRays>();
  const std::int64_t resources = resources_here(config, options.transport);
  first_router_ = static_cast<std::size_t>(resources) % threads_;
  if (Schedule::current() != nullptr)
    first_worker_ = static_cast<std::size_t>(resources + routers_of(config)) % threads_;
  build();
}

void NativeParts::build() {
  ports_.clear();
  routers_.clear();
  workers_.clear();
  machine_ = std::make_unique<NativeMachine>(config_, accel_, scene_size_, own_links_, options_.transport, threads_);
  const NativePortSettings settings{resource_settings(config_, scene_size_), config_.faults, config_.engine.clock_mhz};
  const RankShare& share = machine_->shared.share;
  for (std::uint32_t r = 0; r < sinks_.size(); ++r)
    if (share.here(ResourceId(r)))
      ports_.push_back(std::make_unique<NativePort>(ResourceId(r), *machine_, settings, sinks_[r].get()));
  const Topology& topology = machine_->shared.topology;
  for (std::size_t h = 0; h < topology.hubs().size(); ++h)
    routers_.push_back(std::make_unique<NativeRouter>(ResourceId(static_cast<std::uint32_t>(topology.resources() + h)),
                                                      *machine_, config_.faults.links.any()));
  if (!recorder_ && (options_.timeline.most > 0 || options_.ray != nullptr))
    recorder_ = std::make_unique<NativeRecorder>(config_, share, machine_->shared.packets.size(), options_.timeline,
                                                 options_.ray);
  if (recorder_ && machine_->gate) machine_->gate->record(*recorder_);
  for (std::size_t r = 0; recorder_ && r < ports_.size(); ++r) ports_[r]->record(*recorder_);
  for (std::size_t h = 0; recorder_ && h < routers_.size(); ++h) routers_[h]->record(*recorder_);
  for (const auto& link : machine_->links) link->count(options_.statistics && options_.link_statistics);
  const auto slots = static_cast<std::int64_t>(machine_->shared.control.free_slots());  // that this rank fills
  for (std::uint32_t w = 0; w < static_cast<std::uint32_t>(shader_workers(config_)); ++w)
    workers_.push_back(std::make_unique<ShaderWorker>(WorkerId(w), machine_->shared.control, machine_->completed,
                                                      workload_, count_, slots, shader_workers(config_),
                                                      config_.rays.sort, ledger_.get()));
}

NativeParts::Step NativeParts::step(std::size_t thread) {
  Step out;
  for (std::size_t r = thread; r < ports_.size(); r += threads_) {
    out.moved |= ports_[r]->step();
    out.rests |= ports_[r]->rests();
  }
  for (std::size_t h = (thread + threads_ - first_router_) % threads_; h < routers_.size(); h += threads_)
    out.moved |= routers_[h]->step();
  for (std::size_t w = (thread + threads_ - first_worker_) % threads_; w < workers_.size(); w += threads_)
    out.moved |= workers_[w]->step();
  return out;
}

// When the last ray has been shaded, packets may still be on their way to their owners, through resources of any
// thread. From then on none is sent out any more, so a sum of zero stays zero.
std::uint64_t NativeParts::packets_out() const {
  std::uint64_t out = 0;
  for (const auto& port : ports_) out += port->packets_out();
  return out;
}

void NativeParts::check_drained() const {
  if (count_.emitted != count_.completed)
    throw SimulationError(fmt::format("{} rays emitted, {} completed", count_.emitted.load(), count_.completed.load()));
  for (const auto& port : ports_)
    if (!port->drained()) throw SimulationError("something was left behind: " + port->describe());
  for (const auto& router : routers_)
    if (!router->empty()) throw SimulationError("something was left behind: " + router->describe());
}

std::string NativeParts::describe() const {
  std::string text;
  for (const auto& port : ports_) text += "\n  " + port->describe();
  for (const auto& router : routers_)
    if (!router->empty()) text += "\n  " + router->describe();
  if (machine_->gate) text += "\n  " + machine_->gate->describe();
  return text;
}

void NativeParts::add_to(RunResult& out) const {
  out.rays_emitted = count_.emitted;
  out.rays_completed = count_.completed;
  for (const auto& port : ports_) out.packets_discarded += port->packets_discarded();
  out.slots_used += machine_->shared.control.slots_used();
  out.slot_waits += machine_->shared.control.slot_waits();
  out.completed += machine_->completed.use();
  out.groups += machine_->shared.control.groups_sent();
  for (const auto& sink : sinks_)
    if (sink) out.resources.push_back(sink->statistics());
  out.collections.resize(sinks_.size());
  for (const auto& port : ports_)
    out.collections[port->resource().id().value] = port->resource().collections().statistics();
  for (const auto& link : machine_->links)
    out.links.push_back(
        {link->from(), link->to(), link->capacity(), link->statistics(), link->series(), link->faults()});
}

}  // namespace carousel::ringbus
