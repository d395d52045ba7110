#include "ringbus/rays/bundle_builder.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <glm/common.hpp>
#include <glm/geometric.hpp>

#include "accel/traverse/ray_check.h"

namespace carousel::ringbus {
namespace {

double largest(const DVec3& v) {
  return std::max({v.x, v.y, v.z});
}

std::uint32_t sign_bits(const Vec3& v) {
  std::uint32_t bits = 0;
  for (int axis = 0; axis < 3; ++axis) bits |= std::uint32_t{std::signbit(v[axis])} << axis;
  return bits;
}

}  // namespace

BundleBuilder::Bounds::Bounds(const Ray& ray)
    : origin_min(ray.origin),
      origin_max(ray.origin),
      direction_min(ray.direction),
      direction_max(ray.direction),
      longest(glm::length(DVec3(ray.direction))) {}

void BundleBuilder::Bounds::extend(const Bounds& other) {
  origin_min = glm::min(origin_min, other.origin_min);
  origin_max = glm::max(origin_max, other.origin_max);
  direction_min = glm::min(direction_min, other.direction_min);
  direction_max = glm::max(direction_max, other.direction_max);
  longest = std::max(longest, other.longest);
}

BundleBuilder::BundleBuilder(const BundlesConfig& config, float scene_size)
    : config_(config), scene_size_(scene_size) {}

bool BundleBuilder::may_share(const RayRequest& request) const {
  using Sources = BundlesConfig::Sources;
  const bool from_camera = request.tag.kind == RayKind::kCamera;
  if (config_.sources != Sources::kAll && from_camera != (config_.sources == Sources::kCamera)) return false;
  if (config_.hint == BundlesConfig::Hint::kObey && (request.tag.flags & kRayAlone) != 0) return false;
  return config_.size > 1 && request.ray.tmin == 0 && accel::valid(request.ray);
}

bool BundleBuilder::may_join(const RayRequest& request, const Open& open) const {
  if (request.tag.kind != open.kind) return false;  // they end differently
  if (config_.builder.same_signs && sign_bits(request.ray.direction) != open.signs) return false;
  return !config_.builder.same_origin || request.ray.origin == open.bounds.origin_min;
}

// The scale of origins is the scene's size, that of directions the longest of them. The bundle test sees ranges of
// components, so directions of different lengths are dissimilar even if they are parallel.
double BundleBuilder::size_of(const Bounds& b) const {
  using Similarity = BundlesConfig::Builder::Similarity;
  const double origins = scene_size_ > 0 ? largest(DVec3(b.origin_max) - DVec3(b.origin_min)) / scene_size_ : 0;
  const DVec3 least(b.direction_min), most(b.direction_max), range = (most - least) / b.longest;
  switch (config_.builder.similarity) {
    case Similarity::kGrowth:
      return std::max(origins, largest(range));
    case Similarity::kSolidAngle: {  // solid angle of the box of directions, seen from the origin
      const DVec3 along = glm::abs(0.5 * (least + most)) / b.longest;
      return along.x * range.y * range.z + along.y * range.z * range.x + along.z * range.x * range.y;
    }
    case Similarity::kComponentRange:
      return largest(range);
    case Similarity::kOriginBox:
      return origins;
  }
  return 0;
}

// A bundle without a size has no percentage to grow by: there the size itself counts.
double BundleBuilder::dissimilarity(double before, double after) const {
  const bool percent = config_.builder.measure == BundlesConfig::Builder::Measure::kPercent;
  return percent && before > 0 ? (after - before) / before : after;
}

void BundleBuilder::send(std::size_t place, Groups& out) {
  const std::uint32_t which = oldest_first_[place];
  const Open& bundle = open_[which];
  out.order.insert(out.order.end(), bundle.rays.data(), bundle.rays.data() + bundle.count);
  if (bundle.count >= static_cast<std::size_t>(config_.min_rays))
    out.sizes.push_back(static_cast<std::uint8_t>(bundle.count));
  else
    out.sizes.insert(out.sizes.end(), bundle.count, 1);
  oldest_first_.erase(oldest_first_.begin() + static_cast<std::ptrdiff_t>(place));
  unused_.push_back(which);
}

void BundleBuilder::open(std::uint32_t index, const RayRequest& request, Groups& out) {
  if (oldest_first_.size() == static_cast<std::size_t>(config_.builder.open)) {
    // The fullest has least to gain from waiting. Among several the oldest goes.
    const auto fuller = [&](std::uint32_t a, std::uint32_t b) { return open_[a].count < open_[b].count; };
    const auto fullest = std::max_element(oldest_first_.begin(), oldest_first_.end(), fuller);
    send(static_cast<std::size_t>(fullest - oldest_first_.begin()), out);
  }
  const Bounds bounds(request.ray);
  Open bundle{bounds, size_of(bounds), looked_at_, request.tag.kind, sign_bits(request.ray.direction), 1, {index}};
  if (unused_.empty()) {
    unused_.push_back(static_cast<std::uint32_t>(open_.size()));
    open_.emplace_back(bundle);
  } else {
    open_[unused_.back()] = bundle;
  }
  oldest_first_.push_back(unused_.back());
  unused_.pop_back();
}

void BundleBuilder::take(std::uint32_t index, const RayRequest& request, Groups& out) {
  while (!oldest_first_.empty() &&
         looked_at_ - open_[oldest_first_.front()].opened >= static_cast<std::uint64_t>(config_.builder.age))
    send(0, out);

  constexpr std::size_t kNone = ~std::size_t{0};
  std::size_t best = kNone;
  double least = std::numeric_limits<double>::infinity(), best_size = 0;
  for (std::size_t place = 0; place < oldest_first_.size(); ++place) {
    const Open& bundle = open_[oldest_first_[place]];
    if (!may_join(request, bundle)) continue;
    Bounds with = bundle.bounds;
    with.extend(Bounds(request.ray));
    const double size = size_of(with), unlike = dissimilarity(bundle.size, size);
    if (!(unlike <= config_.builder.threshold) || !(unlike < least)) continue;
    best = place, least = unlike, best_size = size;
  }
  if (best == kNone) {
    open(index, request, out);
  } else {
    Open& bundle = open_[oldest_first_[best]];
    bundle.bounds.extend(Bounds(request.ray));
    bundle.size = best_size;
    bundle.rays[bundle.count++] = index;
    if (bundle.count == full_) send(best, out);
  }
  ++looked_at_;
}

void BundleBuilder::group(std::span<const RayRequest> rays, std::vector<std::uint32_t>& order,
                          std::vector<std::uint8_t>& sizes, std::size_t most) {
  order.clear();
  sizes.clear();
  full_ = std::min(most, static_cast<std::size_t>(config_.size));
  const bool any = full_ >= static_cast<std::size_t>(config_.min_rays);
  Groups out{order, sizes};
  for (std::uint32_t i = 0; i < rays.size(); ++i) {
    if (any && may_share(rays[i])) {
      take(i, rays[i], out);
    } else {
      order.push_back(i);
      sizes.push_back(1);
    }
  }
  while (!oldest_first_.empty()) send(0, out);
}

}  // namespace carousel::ringbus
