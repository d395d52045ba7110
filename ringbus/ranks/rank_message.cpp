#include "ringbus/ranks/rank_message.h"

#include "core/system/error.h"
#include "ringbus/packets/word_stream.h"

namespace carousel::ringbus {

namespace {

/// The parts of a message in their order on the wire.
template <class Visitor, class SomeMessage>
void visit_message(Visitor& visitor, SomeMessage& message) {
  visitor.part(message.credits);
  visitor.part(message.rays);
  visitor.part(message.rays_taken);
  visitor.part(message.results);
  visitor.part(message.packets);
  visitor.part(message.images);
  visitor.part(message.guests);
  visitor.part(message.shapes);
}

/// Bits of the word that says which of the parts follow that most messages have not.
constexpr std::uint64_t kHasToken = 1, kHasFarewell = 2, kHasTrips = 4, kHungry = 8;

}  // namespace

void RankMessage::add(std::uint32_t wire, PacketId id, const Packet& packet) {
  const std::size_t first = images.size();
  append_image(packet, images);
  packets.push_back({wire, id, static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(images.size() - first)});
}

void RankMessage::restore_packet(std::size_t i, Packet& packet) const {
  const PacketOnWire& at = packets[i];
  if (std::size_t{at.first} + at.words > images.size())
    throw SimulationError("a message between ranks names a packet that is not in it");
  restore(std::span(images).subspan(at.first, at.words), packet);
}

std::span<const std::uint64_t> RankMessage::shapes_of(std::size_t i) const {
  const ShapesOnWire& at = guests[i];
  if (std::size_t{at.first} + at.words > shapes.size())
    throw SimulationError("a message between ranks names shapes that are not in it");
  return std::span(shapes).subspan(at.first, at.words);
}

void RankMessage::clear() {
  credits.clear();
  rays.clear();
  results.clear();
  packets.clear();
  trips.clear();
  images.clear();
  guests.clear();
  shapes.clear();
  token.reset();
  farewell.reset();
}

void RankMessage::write(std::vector<std::uint64_t>& words) const {
  words.clear();
  WordWriter writer(words);
  writer.part((token ? kHasToken : 0) | (farewell ? kHasFarewell : 0) | (trips.empty() ? 0 : kHasTrips) |
              (hungry ? kHungry : 0));
  visit_message(writer, *this);
  if (token) writer.part(*token);
  if (!trips.empty()) writer.part(trips);
  if (!farewell) return;
  writer.part(farewell->reason);
  writer.part(std::vector<char>(farewell->text.begin(), farewell->text.end()));
}

void RankMessage::read(std::span<const std::uint64_t> words) {
  WordReader reader(words);
  std::uint64_t has = 0;
  reader.part(has);
  visit_message(reader, *this);
  hungry = (has & kHungry) != 0;
  token.reset();
  trips.clear();
  farewell.reset();
  if ((has & kHasToken) != 0) reader.part(token.emplace());
  if ((has & kHasTrips) != 0) {
    reader.part(trips);
    if (trips.size() != packets.size()) throw SimulationError("a message between ranks has other packets than trips");
  }
  if ((has & kHasFarewell) != 0) {
    reader.part(farewell.emplace().reason);
    std::vector<char> text;
    reader.part(text);
    farewell->text.assign(text.begin(), text.end());
  }
  if (!reader.at_end()) throw SimulationError("a message between ranks is longer than its parts");
}

}  // namespace carousel::ringbus
