#pragma once

#include "ringbus/cycle/fabric/ports.h"
#include "ringbus/time/channel.h"

namespace carousel::ringbus {

/// A list of the channel's own, for tests of one part without a machine.
struct OwnList {
  ChannelList list;
  ChannelPlace place() { return list.at(list.carry({"messages", "a part", "another", "a wire", 1}, 1), {}); }
};

template <class T, bool Returns = false>
class LooseChannel : OwnList, public Channel<T, Returns> {
 public:
  LooseChannel() : Channel<T, Returns>(place()) {}
};

namespace cycle {

class LooseWire : OwnList, public Wire {
 public:
  LooseWire() : Wire(place()) {}
};

}  // namespace cycle
}  // namespace carousel::ringbus
