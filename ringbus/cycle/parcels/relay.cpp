#include "ringbus/cycle/parcels/relay.h"

#include <algorithm>
#include <utility>

namespace carousel::ringbus::cycle {

void Relay::put_door(std::uint32_t number, std::unique_ptr<Door> door) {
  if (doors_.size() <= number) doors_.resize(number + 1);
  doors_[number] = std::move(door);
}

Cycle Relay::next() const {
  Cycle first = kNever;
  for (const Channel<Parcel>* in : in_) first = std::min(first, in->next());
  for (const std::unique_ptr<Door>& door : doors_)
    if (door) first = std::min(first, door->next());
  return first;
}

void Relay::run(Cycle end) {
  for (next_ = next(); next_ < end; next_ = next()) {
    const Cycle now = last_step_ = next_;
    for (Channel<Parcel>* in : in_)
      while (in->next() <= now) {
        Parcel parcel = in->take();
        if (parcel.stop == node_)
          doors_[parcel.door]->deliver(std::move(parcel), now);
        else
          forward(std::move(parcel), now);
      }
    for (const std::unique_ptr<Door>& door : doors_)
      if (door) door->collect(now, collected_);
    for (Parcel& parcel : collected_) forward(std::move(parcel), now);
    collected_.clear();
  }
}

void Relay::forward(Parcel&& parcel, Cycle now) {
  const ParcelRoutes::Exit exit = routes_.exit(parcel.what, node_, parcel.stop);
  parcel.through = exit.through;
  out_[exit.port].send(std::move(parcel), now + cycles_);
}

}  // namespace carousel::ringbus::cycle
