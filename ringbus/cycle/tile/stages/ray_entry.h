#pragma once

#include <cstddef>
#include <utility>

#include "ringbus/cycle/rays/travelling_rays.h"
#include "ringbus/cycle/tile/stages/collection_room.h"
#include "ringbus/cycle/tile/stages/dispatch_stage.h"
#include "ringbus/cycle/tile/stages/egress.h"

namespace carousel::ringbus::cycle {

/// The way of new rays into a resource: beside the links from ray control, which has given them slots; or in packets,
/// out of the queue in which they wait, through resources with free slots, and back here, from where their IDs are
/// admitted (`rays.placement: first_taker`, `addressed`).
class RayEntry {
 public:
  /// Keeps references.
  RayEntry(Machine& machine, Resource& resource, PortLogic& logic, Channel<NewRays>& arrivals,
           TravellingRays& travelling, DispatchStage& dispatch, Egress& egress, CollectionRoom& room,
           TileRecorder& recorder)
      : machine_(machine),
        resource_(resource),
        logic_(logic),
        arrivals_(arrivals),
        travelling_(travelling),
        dispatch_(dispatch),
        egress_(egress),
        room_(room),
        recorder_(recorder) {}

  /// The next arrival from ray control.
  Cycle next_arrival() const { return arrivals_.next(); }
  /// Takes in what ray control has sent; orders go to `on_order(order)`.
  template <class OnOrder>
  void take(Cycle now, const OnOrder& on_order) {
    while (arrivals_.next() <= now) {
      NewRays rays = arrivals_.take();
      if (rays.order != NewRays::Order::kTake)
        on_order(rays.order);
      else if (!rays.rays.empty())
        travelling_.arrive(std::move(rays));
      else if (!logic_.only_forwards())
        logic_.admission.add(std::move(rays.ids));
    }
  }
  /// Moves rays into the root's collection. Returns whether anything has changed.
  bool admit(Cycle now);

  /// A group waits to go round the ring.
  bool waiting() const { return travelling_.waiting(); }
  /// Sends the group that has waited longest. `issue_is_empty`: no packet of this resource waits to be issued.
  bool send(Cycle now, bool issue_is_empty);
  /// A packet of another resource has brought new rays.
  void visit(PacketId id, Cycle now);
  /// A packet of this resource with new rays is back.
  void retire(PacketId id, Cycle now);

  Cycle next() const { return travelling_.next(); }
  bool at_rest() const { return travelling_.at_rest(); }
  std::size_t packets_out() const { return packets_out_; }

 private:
  Cycle take_slots(Packet& packet, Cycle now);
  void return_home(PacketId id, Cycle now);
  void note_placed(Cycle now) {
    if (travelling_.taken() > 0) recorder_.step(now, StepKind::kPlace, 0, travelling_.taken());
  }

  Machine& machine_;
  Resource& resource_;
  PortLogic& logic_;
  Channel<NewRays>& arrivals_;
  TravellingRays& travelling_;
  DispatchStage& dispatch_;
  Egress& egress_;
  CollectionRoom& room_;
  TileRecorder& recorder_;
  std::size_t packets_out_ = 0;  // of its own, with new rays
};

}  // namespace carousel::ringbus::cycle
