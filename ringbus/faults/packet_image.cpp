#include "ringbus/faults/packet_image.h"

#include <cstring>
#include <type_traits>

namespace carousel::ringbus {

namespace {

/// Puts values one behind the other, each in words of its own.
class ImageWriter {
 public:
  template <class T>
  void part(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    append(&value, sizeof value);
  }
  template <class T>
  void part(const std::vector<T>& values) {
    static_assert(std::is_trivially_copyable_v<T>);
    image.push_back(values.size());
    append(values.data(), values.size() * sizeof(T));
  }
  PacketImage image;

 private:
  void append(const void* from, std::size_t bytes) {
    if (bytes == 0) return;
    const std::size_t at = image.size();
    image.resize(at + (bytes + 7) / 8);
    std::memcpy(image.data() + at, from, bytes);
  }
};

class ImageReader {
 public:
  explicit ImageReader(std::span<const std::uint64_t> image) : left_(image) {}

  template <class T>
  void part(T& value) {
    take(&value, sizeof value);
  }
  template <class T>
  void part(std::vector<T>& values) {
    values.resize(left_.front());
    left_ = left_.subspan(1);
    take(values.data(), values.size() * sizeof(T));
  }

 private:
  void take(void* to, std::size_t bytes) {
    if (bytes == 0) return;
    std::memcpy(to, left_.data(), bytes);
    left_ = left_.subspan((bytes + 7) / 8);
  }
  std::span<const std::uint64_t> left_;
};

/// The parts of a packet in their order on the wire.
template <class Visitor, class SomePacket>
void visit(Visitor& visitor, SomePacket& packet) {
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
  ImageWriter writer;
  visit(writer, packet);
  return std::move(writer.image);
}

void restore(std::span<const std::uint64_t> image, Packet& packet) {
  ImageReader reader(image);
  visit(reader, packet);
}

}  // namespace carousel::ringbus
