#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/config/fields/bundles.h"
#include "core/types/workload.h"

namespace carousel::ringbus {

/// Groups similar rays (US 11308683): each joins the open bundle that it fits best, or opens one. A bundle is sent on
/// when it is full, when it is old, when its place is needed (then the fullest, of those the oldest), or at the end of
/// the call. Deterministic.
class BundleBuilder {
 public:
  static constexpr std::size_t kMostRays = 64;

  /// `scene_size` is the scale of distances between origins.
  BundleBuilder(const BundlesConfig& config, float scene_size);

  /// Cuts `rays` into groups: writes the indices of `rays` group by group into `order`, and each group's length into
  /// `sizes`. Every ray is in exactly one group. A ray is alone in its group if it comes from another source than
  /// configured, is not valid, has a tmin other than 0, or found fewer than `min_rays` - 1 others. A group has at most
  /// `size` rays, and no more than `most`. Nothing stays open between calls.
  void group(std::span<const RayRequest> rays, std::vector<std::uint32_t>& order, std::vector<std::uint8_t>& sizes,
             std::size_t most = kMostRays);

 private:
  /// The ranges that similarity is computed from.
  struct Bounds {
    Vec3 origin_min, origin_max, direction_min, direction_max;
    double longest;  ///< length of a direction; the scale of the others

    explicit Bounds(const Ray& ray);
    void extend(const Bounds& other);
  };
  struct Open {
    Bounds bounds;
    double size;           ///< size of the bounds
    std::uint64_t opened;  ///< looked_at_ when it was opened
    RayKind kind;
    std::uint32_t signs;  ///< signs of the components of its directions
    std::size_t count;
    std::array<std::uint32_t, kMostRays> rays;
  };
  struct Groups {
    std::vector<std::uint32_t>& order;
    std::vector<std::uint8_t>& sizes;
  };

  bool may_share(const RayRequest& request) const;
  bool may_join(const RayRequest& request, const Open& open) const;
  double size_of(const Bounds& bounds) const;
  double dissimilarity(double before, double after) const;
  void take(std::uint32_t index, const RayRequest& request, Groups& out);
  void open(std::uint32_t index, const RayRequest& request, Groups& out);
  /// Sends on the bundle at `place` of oldest_first_.
  void send(std::size_t place, Groups& out);

  BundlesConfig config_;
  double scene_size_;
  std::vector<Open> open_;
  std::vector<std::uint32_t> oldest_first_, unused_;  // places in open_
  std::uint64_t looked_at_ = 0;
  std::size_t full_ = kMostRays;  // rays of a full bundle in this call
};

}  // namespace carousel::ringbus
