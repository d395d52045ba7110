#pragma once

#include <cstdint>
#include <vector>

#include "core/config.h"
#include "core/ids.h"
#include "ringbus/packet.h"

namespace carousel::ringbus {

/// Who is wired to whom and which way packets go. `directions` counts the independent cycles a packet can be
/// sent round: 1 for a ring, 2 for a bidirectional one; point to point has one cycle too, with short cuts.
class Topology {
 public:
  explicit Topology(const TopologyConfig& config);

  struct Wire {
    ResourceId from, to;
    std::uint16_t direction;
  };
  /// Every link to make. None when there is only one resource.
  const std::vector<Wire>& wires() const { return wires_; }
  std::size_t resources() const { return resources_; }
  std::size_t directions() const { return directions_; }
  bool point_to_point() const { return point_to_point_; }

  /// Links a packet crosses on its way round; 0 when it need not travel.
  std::uint32_t hops(const Packet& packet) const;
  /// Where the packet at `here` goes next, its owner at last. Point to point with `visit: owners` skips
  /// resources that own none of the members.
  ResourceId next(const Packet& packet, ResourceId here) const;
  /// Whether the packet has to be handled at `here`, or just cuts through.
  bool handles(const Packet& packet, ResourceId here) const;
  /// Whether the packet has anything to do at `r`, its owner apart.
  bool wanted(const Packet& packet, ResourceId r) const;

 private:
  std::uint32_t resources_;
  std::uint16_t directions_;
  bool point_to_point_, visit_all_;
  std::vector<Wire> wires_;
};

/// How many packets each resource may have on the way at once, per direction (DESIGN.md section 4).
std::uint32_t packets_in_flight(const TopologyConfig& config);

}  // namespace carousel::ringbus
