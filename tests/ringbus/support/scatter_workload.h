#pragma once

#include <atomic>
#include <cmath>
#include <cstdint>
#include <mutex>
#include <vector>

#include "core/numeric/digest.h"
#include "core/types/aabb.h"
#include "core/types/workload.h"

namespace carousel::ringbus {

/// Rays that need no shading code: `count` paths start outside or inside the scene's bounds towards points in
/// them; every hit sends on a bounce ray and a shadow ray, up to `bounces`, in directions hashed from the path.
/// Which rays there are depends on the hits, so one wrong hit changes the digest at once and downstream.
class ScatterWorkload final : public Workload {
 public:
  ScatterWorkload(const Aabb& bounds, std::uint32_t count, std::uint8_t bounces, std::uint32_t seed, float away = 0.5f,
                  bool ray_flags = false)
      : bounds_(bounds),
        count_(count),
        bounces_(bounces),
        seed_(seed),
        away_(away),
        ray_flags_(ray_flags),
        seen_(std::size_t{count} * (2u * bounces + 1u)) {}

  Generated generate(WorkerId, std::size_t max_rays, RayBatch& out) override {
    const std::uint32_t begin = next_.fetch_add(static_cast<std::uint32_t>(max_rays));
    if (begin >= count_) return {0, true};
    const std::uint32_t end = begin + static_cast<std::uint32_t>(std::min<std::size_t>(max_rays, count_ - begin));
    for (std::uint32_t path = begin; path < end; ++path) {
      const Vec3 size = bounds_.extent();
      Vec3 from = bounds_.centre(), to = bounds_.lo;
      for (int a = 0; a < 3; ++a) {
        from[a] += size[a] * (1 + 2 * away_) * (number(path, 0, a) - 0.5f);
        to[a] += size[a] * number(path, 0, 3 + a);
      }
      RayRequest r;
      r.ray.origin = from;
      r.ray.direction = to - from;
      r.tag.path = path;
      r.tag.flags = wish(path, 0);
      out.push_back(r);
    }
    return {end - begin, end == count_};
  }

  void shade(WorkerId, const HitBatch& completed, RayBatch& out) override {
    HitsDigest sum;
    for (const RayResult& r : completed) {
      sum.add(hit_term(r.tag.path, 0, r.tag, r.hit));
      const std::size_t index = std::size_t{r.tag.path} * (2u * bounces_ + 1u) +
                                (r.tag.kind == RayKind::kShadow ? 2u * r.tag.bounce + 1u : 2u * r.tag.bounce);
      if (seen_[index].fetch_add(1) != 0) ++doubled_;
      if (r.tag.kind == RayKind::kShadow || !r.hit.valid() || r.tag.bounce >= bounces_) continue;
      const Vec3 at = r.ray.origin + r.hit.t * r.ray.direction;
      RayRequest bounce;
      bounce.ray.origin = at;
      for (int a = 0; a < 3; ++a) bounce.ray.direction[a] = number(r.tag.path, r.tag.bounce + 1u, a) - 0.5f;
      bounce.ray.tmin = 1e-4f * std::fabs(bounds_.extent().x);
      bounce.tag = {r.tag.path, RayKind::kBounce, static_cast<std::uint8_t>(r.tag.bounce + 1), 0,
                    wish(r.tag.path, r.tag.bounce + 1u)};
      out.push_back(bounce);
      RayRequest shadow = bounce;
      shadow.ray.direction = bounds_.hi + Vec3(number(r.tag.path, r.tag.bounce, 7)) - at;
      shadow.ray.tmax = 1.0f;
      shadow.tag = {r.tag.path, RayKind::kShadow, r.tag.bounce, 0, wish(r.tag.path, r.tag.bounce + 100u)};
      out.push_back(shadow);
    }
    const std::lock_guard lock(mutex_);
    digest_.add(sum);
    rays_ += completed.size();
  }

  /// Four shaders: of shadow rays, of rays that hit nothing, and two of those that hit.
  std::uint32_t shader(const RayResult& r) const override {
    if (r.tag.kind == RayKind::kShadow) return 0;
    return r.hit.valid() ? 2 + r.tag.path % 2 : 1;
  }

  HitsDigest digest() const { return digest_; }
  std::uint64_t rays() const { return rays_; }
  /// Rays that were given to shade() more than once.
  std::uint64_t doubled() const { return doubled_; }

 private:
  /// Most rays want nothing in particular.
  std::uint8_t wish(std::uint32_t path, std::uint32_t bounce) const {
    const float n = number(path, bounce, 9);
    return ray_flags_ && n < 0.25f ? static_cast<std::uint8_t>(static_cast<int>(n * 64) & kRequestFlags)
                                   : std::uint8_t{0};
  }
  float number(std::uint32_t path, std::uint32_t bounce, int dimension) const {
    std::uint64_t x = (std::uint64_t{seed_} << 32 | path) * 0x9e3779b97f4a7c15ull + bounce * 64u +
                      static_cast<std::uint32_t>(dimension);
    x ^= x >> 30;
    x *= 0xbf58476d1ce4e5b9ull;
    x ^= x >> 27;
    x *= 0x94d049bb133111ebull;
    x ^= x >> 31;
    return static_cast<float>(x >> 40) * 0x1p-24f;
  }

  Aabb bounds_;
  std::uint32_t count_;
  std::uint8_t bounces_;
  std::uint32_t seed_;
  float away_;
  bool ray_flags_;
  std::vector<std::atomic<std::uint8_t>> seen_;
  std::atomic<std::uint32_t> next_{0};
  std::atomic<std::uint64_t> doubled_{0};
  std::mutex mutex_;
  HitsDigest digest_;
  std::uint64_t rays_ = 0;
};

}  // namespace carousel::ringbus
