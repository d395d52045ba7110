#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/types/workload.h"
#include "ringbus/packets/packet.h"
#include "ringbus/packets/packet_image.h"
#include "ringbus/ranks/end_count.h"

namespace carousel::ringbus {

/// A packet on its way to another rank. Its image stands among those of the message.
struct PacketOnWire {
  std::uint32_t wire = 0;  ///< index into Topology::wires()
  PacketId packet;
  std::uint32_t first = 0, words = 0;  ///< place in RankMessage::images
};

/// Shapes that a packet of the message brings to a rank that does not have them. They stand among those of the message.
struct ShapesOnWire {
  PacketId packet;
  std::uint32_t first = 0, words = 0;  ///< place in RankMessage::shapes
};

/// The number of packets that a link has taken from its other rank and that have been received since the start; so many
/// places of the link are free again.
struct LinkCredit {
  std::uint32_t wire = 0;
  std::uint64_t taken = 0;
};

/// The data of a new ray on its way to its owner.
struct RayOnWire {
  RayId id;
  RayRequest request;
};

/// A completed ray on its way to the rank that leases its slot, and the slot that it leaves.
struct ResultOnWire {
  ResourceId resource;
  std::uint32_t slot = 0;
  RayResult result;
};

/// Says that a rank ends the run, and why. It is the rank's last message.
struct Farewell {
  enum class Reason : std::uint8_t {
    kEnd,    ///< the count has found that all is done
    kStop,   ///< somebody asked for the run to end early
    kFault,  ///< something went wrong; `text` says what
  };
  Reason reason = Reason::kEnd;
  std::string text;
  friend bool operator==(const Farewell&, const Farewell&) = default;
};

/// All that a rank has for another at one time: a message of the native engine between processes. An empty one is a
/// sign of life.
struct RankMessage {
  std::vector<LinkCredit> credits;
  std::vector<RayOnWire> rays;
  bool hungry = false;           ///< the sender had nothing to do at times since its last message
  std::uint64_t rays_taken = 0;  ///< taken of the receiver's rays since the start: their data are in their slots
  std::vector<ResultOnWire> results;
  std::vector<PacketOnWire> packets;
  std::vector<std::uint64_t> trips;  ///< trips of `packets`, for a timeline; empty without one
  PacketImage images;
  std::vector<ShapesOnWire> guests;
  std::vector<std::uint64_t> shapes;  ///< as accel::pack_shapes() writes them
  std::optional<EndToken> token;
  std::optional<Farewell> farewell;

  void add(std::uint32_t wire, PacketId id, const Packet& packet);
  /// Writes the contents of packets[i] back into a packet.
  void restore_packet(std::size_t i, Packet& packet) const;
  /// The shapes of guests[i]. Throws a SimulationError where they are not in the message.
  std::span<const std::uint64_t> shapes_of(std::size_t i) const;
  /// The number of items in the message that EndCount counts.
  std::uint64_t items() const { return rays.size() + results.size() + packets.size(); }
  void clear();

  /// Replaces `words`.
  void write(std::vector<std::uint64_t>& words) const;
  /// Replaces the message by that of `words`. Throws a SimulationError where they are none.
  void read(std::span<const std::uint64_t> words);
};

}  // namespace carousel::ringbus
