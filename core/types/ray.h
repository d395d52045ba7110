#pragma once

#include <cstdint>
#include <limits>

#include "core/types/vec.h"

namespace carousel {

inline constexpr float kInfinity = std::numeric_limits<float>::infinity();
/// Hit::instance of a ray that hit nothing.
inline constexpr std::uint32_t kNoInstance = 0xffffffffu;

/// origin + t * direction for t in [tmin, tmax]; the direction need not be normalised. World space.
struct Ray {
  Vec3 origin{0};
  float tmin = 0;
  Vec3 direction{0, 0, 1};
  float tmax = kInfinity;
};

enum class RayKind : std::uint8_t {
  kCamera,  ///< closest hit, from the camera
  kBounce,  ///< closest hit, from a surface
  kShadow,  ///< any hit: only occluded or visible is known
};
inline constexpr int kRayKinds = 3;

/// Bits of RayTag::flags. Shaders set those that say what the ray wants, before it goes out; the others are the ring's.
enum RayFlag : std::uint8_t {
  kRayDone = 1,         ///< a shadow ray that found its hit: nothing more is tested
  kRayCullBack = 2,     ///< triangles that turn their back are not there: those whose vertices it sees clockwise
  kRayCullFront = 4,    ///< triangles that show their front are not there
  kRayForceOpaque = 8,  ///< nothing is asked, whatever lets rays through (core/types/any_hit.h)
  kRayAlone = 16,       ///< unlike its neighbours, and not worth a place in a bundle: no more than a hint
  kRayAll = 64,         ///< no hit ends its way: each is reported (core/types/hit_sink.h), and the ray misses
  kRayNearest = 128,    ///< it looks for several hits: a buffer lies beside its record (accel/primitive/nearest_ray.h)
  kRayClosest = 32,     ///< a shadow ray that wants to know the first thing in its way, since light may pass that
};
inline constexpr std::uint8_t kRequestFlags =
    kRayCullBack | kRayCullFront | kRayForceOpaque | kRayAlone | kRayClosest | kRayAll;

/// Which ray of the frame this is. `path` indexes the path state of the workload that emitted the ray; with
/// (kind, bounce, index) it is unique among rays in flight.
struct RayTag {
  std::uint32_t path = 0;
  RayKind kind = RayKind::kCamera;
  std::uint8_t bounce = 0;  ///< 0 for camera rays; a shadow ray has the bounce of the surface it leaves
  std::uint8_t index = 0;   ///< index within the kind at one (path, bounce)
  std::uint8_t flags = 0;   ///< RayFlag bits
};

/// True if any hit ends the ray's way.
inline bool takes_any_hit(const RayTag& tag) {
  return tag.kind == RayKind::kShadow && (tag.flags & kRayClosest) == 0;
}

/// The closest hit, as section 3 of the design defines it: t is t', the largest of the kernel's t and the
/// entries of the triangle's own box and of its instance's world box; ties go to the smallest
/// (t, instance, primitive). u weighs vertex 1, v vertex 2. While a ray is in flight t is also its current
/// tmax. A miss has instance == kNoInstance, t = +inf, u = v = 0.
struct Hit {
  float t = kInfinity;
  float u = 0, v = 0;
  std::uint32_t instance = kNoInstance;
  std::uint32_t primitive = 0;

  bool valid() const { return instance != kNoInstance; }
};

/// The ray data that stays in its owner's store: one cache line (docs/how-it-works/design.md, The machine).
struct alignas(64) RayRecord {
  Ray ray;
  Hit hit;
  RayTag tag;
  std::int32_t pending = 0;  ///< tests this ray still waits for; written by the owner only
};
static_assert(sizeof(RayRecord) == 64);

}  // namespace carousel
