#pragma once

#include <utility>
#include <variant>
#include <vector>

#include "ringbus/cycle/parcels/door.h"
#include "ringbus/time/channel.h"

namespace carousel::ringbus::cycle {

/// One side of the way of rays between ray control and a resource: it takes in messages of the one kind and hands out
/// those of the other. A kind that has wires of its own has no channel here.
template <class In, class Out>
class RayDoor final : public Door {
 public:
  /// `in`: what the part sends, or null; it goes to `to` as `what`. `out`: what comes to the part, or null.
  RayDoor(Channel<In>* in, Carried what, DoorPlace to, Channel<Out>* out) : in_(in), what_(what), to_(to), out_(out) {}

  Cycle next() const override { return in_ != nullptr ? in_->next() : kNever; }
  void collect(Cycle now, std::vector<Parcel>& out) override {
    while (next() <= now) {
      Parcel& parcel = out.emplace_back();
      In message = in_->take();
      parcel.what = what_;
      parcel.stop = to_.node;
      parcel.door = to_.door;
      parcel.size_bytes = message.bytes();
      parcel.body = std::move(message);
    }
  }
  void deliver(Parcel&& parcel, Cycle now) override {
    out_->send(now + kDoorCycles, std::get<Out>(std::move(parcel.body)));
  }

 private:
  Channel<In>* in_;
  Carried what_;
  DoorPlace to_;
  Channel<Out>* out_;
};

}  // namespace carousel::ringbus::cycle
