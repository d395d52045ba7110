#pragma once

#include <memory>
#include <utility>

#include "ringbus/cycle/parcels/link_time.h"
#include "ringbus/cycle/parcels/parcel.h"
#include "ringbus/time/channel.h"

namespace carousel::ringbus::cycle {

/// The near end of a link for parcels, which goes by the clock of the link behind its synchroniser. On a link that
/// packets share, its agent (shared_link.h) gives out the time, and the port hands parcels over to it.
class ParcelPort {
 public:
  /// `away`: latency of the link, or of the way to its agent. `to_link`: from the clock of its node. `time`: null for a
  /// link that is shared.
  ParcelPort(Channel<Parcel>& to, Cycle away, const ClockRatio& to_link, std::unique_ptr<LinkTime> time = nullptr)
      : to_(&to), away_(away), to_link_(to_link), time_(std::move(time)) {}

  /// The parcel may leave the node at `ready`; calls are in order of time.
  void send(Parcel&& parcel, Cycle ready) {
    Cycle leaves = to_link_.enter(ready);
    if (time_) {
      const LinkTime::Passage passage = time_->parcel(parcel.bytes(), leaves);
      leaves = parcel.through ? passage.head : passage.tail;
    }
    to_->send(leaves + away_, std::move(parcel));
  }
  /// Null for a link that is shared.
  LinkTime* time() { return time_.get(); }

 private:
  Channel<Parcel>* to_;
  Cycle away_;
  ClockRatio to_link_;
  std::unique_ptr<LinkTime> time_;
};

}  // namespace carousel::ringbus::cycle
