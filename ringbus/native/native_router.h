#pragma once

#include <cstdint>
#include <deque>
#include <string>
#include <vector>

#include "ringbus/native/native_machine.h"
#include "ringbus/native/native_recorder.h"

namespace carousel::ringbus {

/// A router of a graph in the native engine: passes packets on, each by the link of the shortest way to its stop, which
/// the resource that sent it has written down (NativeMachine::stops). A packet that finds no egress place waits at the
/// end of its link, and holds up those behind it, as in the cycle engine (ringbus/cycle/fabric/router.h). One thread
/// steps it.
class NativeRouter {
 public:
  /// `node`: its number, behind those of the resources. Keeps references.
  NativeRouter(ResourceId node, NativeMachine& machine, bool links_fail);
  /// From now on the packets that it sends are noted.
  void record(NativeRecorder& recorder);

  /// Sends on and takes in all that it can now. Returns whether anything moved.
  bool step();
  /// No packet is here. Call when nothing steps, as the next.
  bool empty() const;
  /// One line that says what waits here; empty if nothing does.
  std::string describe() const;

 private:
  struct InPort {
    Link* link;
    std::deque<PacketId> waiting;  // taken off the link; the first one has found no place
  };
  struct OutPort {
    Link* link;
    std::uint32_t wire;
    std::deque<PacketId> egress;
  };

  bool send();
  bool take_in();
  bool pass_on(InPort& in);

  ResourceId node_;
  const Topology& topology_;
  const std::vector<ResourceId>& stops_;
  const std::vector<Packet>& packets_;  // of which it reads the direction alone, which never changes
  bool links_fail_;
  std::size_t places_;  // of each egress queue
  std::vector<InPort> in_ports_;
  std::vector<OutPort> out_ports_;
  std::size_t turn_ = 0;  // the link whose packets are taken first
  NativeRecorder* recorder_ = nullptr;
  Recording recording_;
};

}  // namespace carousel::ringbus
