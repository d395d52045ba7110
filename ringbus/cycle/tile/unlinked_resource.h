#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "ringbus/cycle/shapes/shape_buffer.h"
#include "ringbus/cycle/testers/tester.h"
#include "ringbus/cycle/tile/resource_agent.h"
#include "ringbus/cycle/tile/resource_samples.h"
#include "ringbus/cycle/tile/stages/tile_settings.h"
#include "ringbus/cycle/tile/tile_ledger.h"
#include "ringbus/cycle/tile/walk/ray_walk.h"
#include "ringbus/protocol/machine.h"

namespace carousel::ringbus::cycle {

/// What the two resources of the conventional machine have alike: each traces its own rays depth-first with units and a
/// shape buffer of its own, and has no links, packets or collections.
class UnlinkedResource : public ResourceAgent {
 public:
  bool polled() const final { return false; }
  Cycle last_event() const final { return now_; }
  void close(Cycle end) final {
    samples_.close(end, [this](Cycle at, std::span<std::uint64_t> row) { read(at, row); });
    ledger_.close(end);
    tester_.close(end);
  }
  ShapeBuffer& shape_buffer() final { return shapes_; }
  ResourceStatistics statistics() const final {
    ResourceStatistics s = sink_.statistics();
    // Rays are tested one by one, not as members of packets.
    s.visits = s.seen_rays = 0;
    s.nodes.clear();
    return s;
  }
  CollectionStore::Statistics collections() const final { return {}; }
  const std::vector<OutPort>& out() const final { return no_links_; }
  std::string blocked(std::size_t) const final { return ""; }
  const Trace& trace() const final { return trace_; }
  const CounterSamples& samples() const final { return samples_; }

 protected:
  /// Keeps references to the machine and its memory.
  UnlinkedResource(ResourceId id, Machine& machine, const ShapeMemory& memory, const TileSettings& settings,
                   const SidePorts& ports)
      : accel_(machine.accel),
        memory_(memory),
        id_(id),
        store_(*machine.stores[id.value]),
        statistics_(settings.statistics),
        trace_(id.value, settings.observed.steps),
        tester_(settings.testers, settings.plane_order, settings.reads_per_cycle),
        shapes_(settings.memory, settings.link, ports),
        transforms_(settings.accuracy, machine.accel, store_.slots()),
        ledger_(tester_),
        samples_(settings.observed.samples, kFirstPortCounter),
        recording_(settings.recording) {
    if (recording_.slices != nullptr && recording_.ray == nullptr)
      tester_.record(*recording_.slices, recording_.track + 1 + recording_.contexts);
  }

  /// Samples that are due, and the cycle in which it does something.
  void begin_step(Cycle now) {
    if (samples_.due(now)) [[unlikely]]
      samples_.until(now, [this](Cycle at, std::span<std::uint64_t> row) { read(at, row); });
    now_ = now;
  }
  void record(const Event& event) {
    if (statistics_) sink_.record(event);
  }
  void note(RayFact::Kind kind, Cycle at, Cycle end, accel::NodeKey key = {}) {
    recording_.ray->facts.push_back({.kind = kind, .at = at, .end = end, .resource = id_.value, .key = key});
  }

  const accel::Accel& accel_;
  const ShapeMemory& memory_;
  ResourceId id_;
  RayStore& store_;
  bool statistics_;
  StatisticsSink sink_;
  Trace trace_;
  Tester tester_;
  ShapeBuffer shapes_;
  TransformAccount transforms_;
  std::size_t active_ = 0;  // rays in slots
  Cycle now_ = 0;
  TileLedger ledger_;
  CounterSamples samples_;
  Recording recording_;

 private:
  void read(Cycle at, std::span<std::uint64_t> row) {
    read_units(tester_, at, row);
    row[counter_index(ResourceCounter::kCompleted)] = sink_.statistics().rays_completed;
    row[counter_index(ResourceCounter::kTested)] = sink_.statistics().local_rays;
  }

  std::vector<OutPort> no_links_;
};

}  // namespace carousel::ringbus::cycle
