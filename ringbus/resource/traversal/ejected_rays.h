#pragma once

#include <bit>
#include <compare>
#include <cstdint>
#include <optional>
#include <tuple>
#include <vector>

#include "core/config/fields/bundles.h"
#include "ringbus/packets/packet.h"
#include "ringbus/rays/bundle_builder.h"
#include "ringbus/rays/ray_store.h"

namespace carousel::ringbus {

/// The rays that leave their bundles during a visit, each for some of the node's children or, untested, for the same
/// node again. They go on in the packet on their own, or, if split bundles go back to the builder, in new bundles of
/// rays for the same children.
class EjectedRays {
 public:
  /// Keeps a reference to `store`.
  EjectedRays(const BundlesConfig& config, float scene_size, RayStore& store);

  void begin() { rays_.clear(); }
  void add(std::uint32_t slot, std::uint8_t mask) { rays_.push_back({slot, mask, most_}); }
  /// For the same node again, in a bundle of at most `most` rays.
  void add_again(std::uint32_t slot, std::uint8_t most) { rays_.push_back({slot, 0, most}); }
  /// The number of rays that pass the builder.
  std::uint32_t regrouped() const { return builder_ ? static_cast<std::uint32_t>(rays_.size()) : 0; }
  /// Appends them to the packet's members, with counts for the tests to come. New bundles take slots from the end of
  /// `free_bundles`.
  void send(Packet& packet, std::vector<std::uint32_t>& free_bundles);

 private:
  struct EjectedRay {
    std::uint32_t slot;
    std::uint8_t mask;  // 0: the same node again
    std::uint8_t most;  // rays of a new bundle

    friend auto operator<=>(const EjectedRay& a, const EjectedRay& b) {
      return std::tie(a.mask, a.most) <=> std::tie(b.mask, b.most);
    }
    int tests() const { return mask == 0 ? 1 : std::popcount(mask); }
  };

  void send_alone(Packet& packet, const EjectedRay& ray);
  void send_bundles(Packet& packet, std::size_t first, std::size_t end, std::vector<std::uint32_t>& free_bundles);

  RayStore& store_;
  std::uint8_t most_;
  std::optional<BundleBuilder> builder_;  // nothing: every ray on its own
  std::vector<EjectedRay> rays_;
  // Scratch.
  RayBatch requests_;
  std::vector<std::uint32_t> order_, slots_;
  std::vector<std::uint8_t> sizes_;
};

}  // namespace carousel::ringbus
