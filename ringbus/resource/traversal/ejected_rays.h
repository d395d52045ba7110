#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/config/config.h"
#include "ringbus/packets/packet.h"
#include "ringbus/rays/bundle_builder.h"
#include "ringbus/rays/ray_store.h"

namespace carousel::ringbus {

/// The rays that leave their bundles during a visit, each for some of the node's children. They go on in the packet on
/// their own, or, if split bundles go back to the builder, in new bundles of rays for the same children.
class EjectedRays {
 public:
  /// Keeps a reference to `store`.
  EjectedRays(const BundlesConfig& config, float scene_size, RayStore& store);

  void begin() { rays_.clear(); }
  void add(std::uint32_t slot, std::uint8_t mask) { rays_.push_back({slot, mask}); }
  /// The number of rays that pass the builder.
  std::uint32_t regrouped() const { return builder_ ? static_cast<std::uint32_t>(rays_.size()) : 0; }
  /// Appends them to the packet's members, with counts for the tests to come. New bundles take slots from the end of
  /// `free_bundles`.
  void send(Packet& packet, std::vector<std::uint32_t>& free_bundles);

 private:
  struct EjectedRay {
    std::uint32_t slot;
    std::uint8_t mask;
  };

  void send_alone(Packet& packet, std::uint32_t slot, std::uint8_t mask);
  void send_bundles(Packet& packet, std::size_t first, std::size_t end, std::vector<std::uint32_t>& free_bundles);

  RayStore& store_;
  std::optional<BundleBuilder> builder_;  // nothing: every ray on its own
  std::vector<EjectedRay> rays_;
  // Scratch.
  RayBatch requests_;
  std::vector<std::uint32_t> order_, slots_;
  std::vector<std::uint8_t> sizes_;
};

}  // namespace carousel::ringbus
