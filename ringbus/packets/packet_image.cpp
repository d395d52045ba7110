#include "ringbus/packets/packet_image.h"

#include "ringbus/packets/word_stream.h"

namespace carousel::ringbus {

namespace {

/// The parts of a packet in their order on the wire.
template <class Visitor, class SomePacket>
void visit_packet(Visitor& visitor, SomePacket& packet) {
  visitor.part(packet.kind);
  visitor.part(packet.owner);
  visitor.part(packet.home);
  visitor.part(packet.key);
  visitor.part(packet.lanes);
  visitor.part(packet.depth);
  visitor.part(packet.direction);
  visitor.part(packet.hops_left);
  visitor.part(packet.reserved_blocks);
  visitor.part(packet.members);
  visitor.part(packet.nearest);
  visitor.part(packet.next);
  visitor.part(packet.requests);
  visitor.part(packet.addresses);
  visitor.part(packet.owners);
}

}  // namespace

PacketImage image_of(const Packet& packet) {
  PacketImage image;
  append_image(packet, image);
  return image;
}

void append_image(const Packet& packet, PacketImage& image) {
  WordWriter writer(image);
  visit_packet(writer, packet);
}

void restore(std::span<const std::uint64_t> image, Packet& packet) {
  WordReader reader(image);
  visit_packet(reader, packet);
}

}  // namespace carousel::ringbus
