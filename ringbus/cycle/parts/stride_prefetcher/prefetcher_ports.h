#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "core/config/parts/stride_prefetcher.h"
#include "ringbus/cycle/messages/side_wire.h"
#include "ringbus/cycle/parts/attached_part.h"

namespace carousel::ringbus::cycle {

/// The wires of a prefetcher, whatever its rule: hints from the resources behind its L2, and requests to that.
class PrefetcherPorts {
 public:
  struct Kinds {
    MessageKind hints, requests;
    Kinds(ChannelList& list, const LinkConfig& link);
  };
  PrefetcherPorts(const Kinds& kinds, const PartSites& sites, const PartSite& site);

  /// The ends of its channels at others.
  AttachedPart<StridePrefetcherCounts> ends() const;
  std::size_t resources() const { return hints_.size(); }

  /// When the next hint comes.
  Cycle next() const {
    Cycle first = kNever;
    for (const auto& channel : hints_) first = std::min(first, channel->next());
    return first;
  }
  /// Calls `take(hint, place of its resource)` for the hints that have come by `now`, in the order of their resources.
  template <class Take>
  void take_until(Cycle now, const Take& take) {
    for (std::size_t i = 0; i < hints_.size(); ++i)
      while (hints_[i]->next() <= now) take(hints_[i]->take(), i);
  }
  /// Asks the L2 for a line that nobody waits for.
  void ask(std::uint64_t line, Cycle now) {
    FetchRequest request{line, 1};
    request.ahead = true;
    requests_->send(wire_.send(request.bytes(), now), request);
  }

 private:
  std::vector<std::unique_ptr<Channel<ShapeHint>>> hints_;  // by resource behind the L2
  std::unique_ptr<Channel<FetchRequest>> requests_;
  SideWire wire_;
};

}  // namespace carousel::ringbus::cycle
