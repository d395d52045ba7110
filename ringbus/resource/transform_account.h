#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "accel/structure/accel.h"
#include "accel/transform/instance_data.h"
#include "core/config/config.h"
#include "core/statistics/ray_bytes.h"

namespace carousel::ringbus {

/// What bringing a resource's rays to model space costs hardware that follows the configuration: the kernels do it
/// anew for every strip. One resource's, one thread at a time.
class TransformAccount {
 public:
  /// Keeps a reference to `accel`.
  TransformAccount(const AccuracyConfig& accuracy, const accel::Accel& accel, std::size_t slots)
      : accel_(accel),
        store_(accuracy.transformed_ray == AccuracyConfig::TransformedRay::kStore),
        forward_(accel::stored_instance_data(accuracy) == AccuracyConfig::InstanceData::kForward),
        kept_(store_ ? slots : 0) {}

  /// Whether rays are moved for `instance` at all.
  bool moves(std::uint32_t instance) const {
    return instance != kNoInstance && !accel_.instances[instance].transform.identity;
  }
  /// Whether the ray in `slot`, about to be tested in `instance`, has to be transformed; its copy may be kept from then
  /// on. `instance` moves rays.
  bool needs(std::uint32_t slot, std::uint32_t instance) {
    if (!store_) return true;
    std::vector<std::uint32_t>& kept = kept_[slot];
    if (std::find(kept.begin(), kept.end(), instance) != kept.end()) {
      bytes_.read += accel::kTransformedRayBytes;
      return false;
    }
    kept.push_back(instance);
    bytes_.written += accel::kTransformedRayBytes;
    held_ += accel::kTransformedRayBytes;
    bytes_.peak = std::max(bytes_.peak, held_);
    return true;
  }
  /// The ray in `slot` is done.
  void forget(std::uint32_t slot) {
    if (!store_) return;
    held_ -= accel::kTransformedRayBytes * kept_[slot].size();
    kept_[slot].clear();
  }
  /// Whether the inverse has to be computed before rays are moved. A transpose needs no computing.
  bool inverts(std::uint32_t instance) const { return forward_ && !accel_.instances[instance].transform.transposed; }

  const TransformedRayBytes& bytes() const { return bytes_; }

 private:
  const accel::Accel& accel_;
  bool store_, forward_;
  std::vector<std::vector<std::uint32_t>> kept_;  // by slot: the instances it has a copy for
  std::uint64_t held_ = 0;
  TransformedRayBytes bytes_;
};

}  // namespace carousel::ringbus
