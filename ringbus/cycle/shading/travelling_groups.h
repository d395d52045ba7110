#pragma once

#include <cstdint>
#include <deque>
#include <vector>

#include "ringbus/cycle/messages/side_ports.h"
#include "ringbus/cycle/rays/load_ports.h"
#include "ringbus/cycle/shading/shading_settings.h"
#include "ringbus/protocol/machine.h"

namespace carousel::ringbus::cycle {

/// New rays that travel round the ring to find slots. Ray control sends no more of them than there are free slots, so
/// that every one finds a slot and packets need not go round for ever. Keeps references to the machine, the clients and
/// the ports.
class TravellingGroups {
 public:
  TravellingGroups(Machine& machine, const ShadingSettings& settings, const std::vector<SidePorts>& clients,
                   LoadPorts& ports);

  /// Takes the groups that ray control has made. A group is cut before each ray for which its resource, or all of them,
  /// would not have enough slots even if they were empty.
  void add(std::uint32_t issuer, const RayGroup& group);
  /// Sends groups in order: one that has to wait holds up those behind it.
  void send(Cycle now);
  /// Rays of a resource have given back their slots.
  void freed(std::uint32_t resource, std::size_t slots) {
    free_slots_[free_slots_.size() == 1 ? 0 : resource] += slots;
  }

 private:
  bool reserve_slots(const RayGroup& group);

  struct Traveller {
    std::uint32_t issuer = 0;
    RayGroup group;
    bool counted = false;  // as one that waits
  };
  Machine& machine_;
  const std::vector<SidePorts>& clients_;
  LoadPorts& ports_;
  Cycle latency_;
  std::deque<Traveller> waiting_;          // for free slots
  std::vector<std::uint64_t> capacity_;    // slots by resource that addresses name, or of all in the first place
  std::vector<std::uint64_t> free_slots_;  // by resource that addresses name, or of all in the first place
};

}  // namespace carousel::ringbus::cycle
