#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/types/workload.h"
#include "ringbus/cycle/messages/side_ports.h"
#include "ringbus/cycle/messages/side_wire.h"
#include "ringbus/cycle/rays/load_ports.h"
#include "ringbus/cycle/rays/slot_use.h"
#include "ringbus/cycle/shading/ray_data.h"
#include "ringbus/cycle/shading/shading_recorder.h"
#include "ringbus/cycle/shading/shading_settings.h"
#include "ringbus/cycle/shading/travelling_groups.h"
#include "ringbus/protocol/machine.h"
#include "ringbus/results/trace.h"

namespace carousel::ringbus::cycle {

/// The way of new rays into slots. They gather until they fill a packet, or until no worker has anything to do, and are
/// then given slots by ray control. With bundles they gather until they would fill the bundles that the builder holds
/// open, and pass the builder `builder.rays_per_cycle` a cycle. A record needs its owner's load port; the IDs of a
/// group go to its issuer when all its records are loaded. Keeps references to all that it is given.
class RayPlacement {
 public:
  RayPlacement(Machine& machine, RayControl& control, const ShadingSettings& settings,
               const std::vector<SidePorts>& clients, ShadingRecorder& recorder, Trace& trace);

  /// New rays, which place() takes.
  RayBatch& gathered() { return gathered_; }
  /// Gives slots to gathered rays that are enough, or the `last` for some time, and sends the groups that have got
  /// slots. Calls `on_submit(rays)` for rays that are handed to ray control.
  template <class OnSubmit>
  void place(Cycle now, bool last, OnSubmit&& on_submit) {
    bool placed = control_.place_waiting();
    if (gathered_.size() >= gather_ || (last && !gathered_.empty())) {
      submit(gathered_, now);
      on_submit(gathered_);
      gathered_.clear();
      placed = true;
    }
    send_placed(placed, now);
  }
  /// Places rays anew after a resource has stopped.
  void place_again(const RayBatch& rays, Cycle now);
  /// Completed rays of a resource have left their slots.
  void free(std::uint32_t resource, const CompletedRays& done, Cycle now);
  /// Sends an order to all resources, behind the rays that were sent before it.
  void order_all(NewRays::Order order, Cycle now);

  /// From now on data of rays is in memory.
  void keep_in_memory(RayData& data) { data_ = &data; }
  /// The records of a group have been read from memory: loads them, and sends the IDs when all are loaded.
  void send_group(std::uint32_t issuer, RayGroup&& group, Cycle now);

  SlotUse& slots() { return slots_; }
  const SlotUse& slots() const { return slots_; }

 private:
  void submit(const RayBatch& rays, Cycle now);
  void send_placed(bool placed, Cycle now);
  void send_groups(Cycle now);
  void place_group(std::uint32_t issuer, const RayGroup& group, Cycle now);

  Machine& machine_;
  RayControl& control_;
  const std::vector<SidePorts>& clients_;
  ShadingRecorder& recorder_;
  Trace& trace_;
  RayData* data_ = nullptr;
  std::size_t gather_;  // new rays that are given slots together
  bool bundled_;
  Cycle builder_rate_, builder_free_ = 0;
  LoadPorts ports_;
  std::vector<SideWire> id_wires_;                // by resource
  std::unique_ptr<TravellingGroups> travelling_;  // where packets bring rays to their slots
  SlotUse slots_;
  RayBatch gathered_;
  std::vector<RayGroup> groups_;        // scratch
  std::vector<RayData::Place> places_;  // scratch
};

}  // namespace carousel::ringbus::cycle
