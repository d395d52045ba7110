#pragma once

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "accel/structure/accel.h"
#include "accel/transform/instance_data.h"
#include "core/config/fields/accuracy.h"
#include "core/statistics/intersection_counts.h"
#include "core/statistics/ray_bytes.h"
#include "core/types/ray.h"

namespace carousel::ringbus {

/// The part of IntersectionCounts that a TransformAccount charges.
struct TransformCounts {
  std::uint64_t transforms = 0, transforms_in_double = 0;
  std::uint64_t inversions = 0, full_inversions = 0, inversions_in_double = 0;
};

/// Counts what it costs hardware that follows the configuration to bring a resource's rays to model space; the kernels
/// do it anew for every strip. It belongs to one resource and is used by one thread at a time.
class TransformAccount {
 public:
  /// Keeps a reference to `accel`.
  TransformAccount(const AccuracyConfig& accuracy, const accel::Accel& accel, std::size_t slots)
      : accel_(accel),
        store_(accuracy.transformed_ray == AccuracyConfig::TransformedRay::kStore),
        forward_(accel::stored_instance_data(accuracy) == AccuracyConfig::InstanceData::kForward),
        full_(accuracy.transform == TransformLevel::kInverseMatrix),
        kept_(store_ ? slots : 0) {}

  /// True if rays are transformed for `instance` at all.
  bool moves(std::uint32_t instance) const {
    return instance != kNoInstance && !accel_.instances[instance].transform.identity;
  }
  /// True if the ray in `slot`, about to be tested in `instance`, has to be transformed; its copy may be kept from then
  /// on. Needs moves(instance).
  bool needs(std::uint32_t slot, std::uint32_t instance) {
    if (!store_) return true;
    std::vector<std::uint32_t>& kept = kept_[slot];
    if (std::find(kept.begin(), kept.end(), instance) != kept.end()) {
      bytes_.read += ray_bytes(instance);
      return false;
    }
    kept.push_back(instance);
    bytes_.written += ray_bytes(instance);
    held_ += ray_bytes(instance);
    bytes_.peak = std::max(bytes_.peak, held_);
    return true;
  }
  /// Charges a visit: of the rays in `slots`, those that are not done and have to be transformed for `instance`, and
  /// one inversion for all of them.
  TransformCounts charge(const RayRecord* records, std::span<const std::uint32_t> slots, std::uint32_t instance) {
    TransformCounts counts;
    if (!moves(instance)) return counts;
    for (const std::uint32_t slot : slots)
      if ((records[slot].tag.flags & kRayDone) == 0) counts.transforms += needs(slot, instance);
    counts.transforms_in_double = in_double(instance) ? counts.transforms : 0;
    if (counts.transforms > 0) invert(instance, counts);
    return counts;
  }
  /// The ray in `slot` is done.
  void forget(std::uint32_t slot) {
    if (!store_) return;
    for (const std::uint32_t instance : kept_[slot]) held_ -= ray_bytes(instance);
    kept_[slot].clear();
  }
  /// True if rays are transformed in double for this instance, at a level that is not.
  bool in_double(std::uint32_t instance) const { return accel_.instances[instance].transform.promoted; }
  /// Counts one inversion if the inverse has to be computed before rays are transformed. A transpose needs no
  /// computing. Instances whose rays are transformed in double take the two steps.
  template <class Counts>
  void invert(std::uint32_t instance, Counts& counts) const {
    counts.inversions = forward_ && !accel_.instances[instance].transform.transposed;
    counts.full_inversions = full_ && !in_double(instance) ? counts.inversions : 0;
    counts.inversions_in_double = in_double(instance) ? counts.inversions : 0;
  }

  const TransformedRayBytes& bytes() const { return bytes_; }

 private:
  /// Bytes of a transformed copy of a ray. A copy in a group's space has the slack of its tests besides.
  std::uint64_t ray_bytes(std::uint32_t instance) const {
    return accel::kTransformedRayBytes + (accel_.is_group(instance) ? 3 * sizeof(float) : 0);
  }

  const accel::Accel& accel_;
  bool store_, forward_, full_;
  std::vector<std::vector<std::uint32_t>> kept_;  // by slot: the instances it has a copy for
  std::uint64_t held_ = 0;
  TransformedRayBytes bytes_;
};

}  // namespace carousel::ringbus
