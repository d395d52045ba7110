#pragma once

#include <memory>
#include <utility>

#include "ringbus/cycle/parcels/link_time.h"
#include "ringbus/cycle/parcels/parcel.h"
#include "ringbus/time/channel.h"

namespace carousel::ringbus::cycle {

/// The near end of a link for parcels. On a link that packets share, its agent (shared_link.h) gives out the time, and
/// the port hands parcels over to it.
class ParcelPort {
 public:
  /// `away`: latency of the link, or of the way to its agent. `width`: bytes a cycle; 0 for a link that is shared.
  ParcelPort(Channel<Parcel>& to, Cycle away, std::uint64_t width) : to_(&to), away_(away) {
    if (width > 0) time_ = std::make_unique<LinkTime>(width);
  }

  /// The parcel may leave at `ready`; calls are in order of time.
  void send(Parcel&& parcel, Cycle ready) {
    Cycle leaves = ready;
    if (time_) {
      const LinkTime::Passage passage = time_->parcel(parcel.bytes(), ready);
      leaves = parcel.through ? passage.head : passage.tail;
    }
    to_->send(leaves + away_, std::move(parcel));
  }
  /// Null for a link that is shared.
  LinkTime* time() { return time_.get(); }

 private:
  Channel<Parcel>* to_;
  Cycle away_;
  std::unique_ptr<LinkTime> time_;
};

}  // namespace carousel::ringbus::cycle
