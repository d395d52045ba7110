#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "accel/transform/transform.h"
#include "accel/traverse/oracle_box.h"
#include "core/config/fields/accuracy.h"
#include "core/program/program.h"
#include "core/types/any_hit.h"
#include "core/types/workload.h"
#include "scene/model/opacity.h"
#include "scene/model/scene.h"

namespace carousel::accel {

/// The definition of a hit (docs/how-it-works/design.md, What a hit is) in scalar code for one primitive of one
/// instance at a time. It knows the scene and no acceleration structure. docs/reference/verify.md lists what it
/// shares with the kernels. Immutable; any thread may call.
class OraclePrimitives {
 public:
  /// Keeps references to the scene, and to `any_hit`, which answers any-hit calls; null: every surface is opaque.
  OraclePrimitives(const scene::Scene& scene, const AccuracyConfig& accuracy, const AnyHit* any_hit);

  /// A ray in the space in which the primitives of an instance are tested.
  struct LocalRay {
    Ray ray;
    OracleBoxTest boxes;
    std::uint32_t instance;
    float entry;  ///< distance at which the ray enters the instance's world box
  };
  /// A place where a ray crosses a primitive between its start and its end. It is a hit if it accepts().
  struct Candidate {
    Hit hit;
    int facing;  ///< 1: the ray sees the primitive's front; -1: its back; 0: neither
  };
  using Candidates = std::array<Candidate, kMostProgramHits>;

  std::uint32_t instances() const { return static_cast<std::uint32_t>(placed_.size()); }
  std::uint32_t primitives(std::uint32_t instance) const;
  /// The primitive's own box, which a hit has to lie in.
  Aabb box(std::uint32_t instance, std::uint32_t primitive) const;
  /// The instance's world box likewise; empty until set_model_box().
  const Aabb& world_box(std::uint32_t instance) const { return placed_[instance].world; }
  /// Tells the box around all primitives of an instance.
  void set_model_box(std::uint32_t instance, const Aabb& box);
  /// True if the primitives of an instance are given in world space, as others of the same mesh need not be.
  bool baked(std::uint32_t instance) const { return placed_[instance].baked; }

  std::size_t size_bytes() const { return placed_.size() * sizeof(Placed); }
  static constexpr std::size_t kInstanceBytes = 256;  ///< at most, of each instance

  /// `world` in an instance whose world box it enters at `entry`.
  LocalRay local_ray(const Ray& world, std::uint32_t instance, float entry) const;
  /// Up to two crossings, the nearer first, or as many as a program reports, in its order; no farther than `tmax` but
  /// for rounding.
  int cross(const LocalRay& ray, std::uint32_t primitive, float tmax, Candidates& out) const;
  /// False if the ray's flags or a non-opaque material let it pass.
  bool accepts(const RayRequest& request, const Candidate& candidate) const;

 private:
  using Corners = std::array<Vec3, 3>;
  struct Placed {
    const scene::Mesh* mesh;
    scene::Affine placement;
    InstanceTransform transform;
    bool baked;
    Aabb world;
  };
  static Corners corners(const Placed& placed, std::uint32_t triangle);
  int cross_triangle(const LocalRay& ray, const Placed& placed, std::uint32_t primitive, float tmax,
                     Candidates& out) const;
  int cross_spheres(const LocalRay& ray, const Placed& placed, std::uint32_t primitive, float tmax,
                    Candidates& out) const;

  int cross_program(const LocalRay& ray, const scene::Sphere& bounds, std::uint32_t primitive, float tmax,
                    Candidates& out) const;

  const scene::Scene& scene_;
  AccuracyConfig accuracy_;
  const AnyHit* any_hit_;
  scene::Opacity opacity_;
  std::vector<Placed> placed_;
};

}  // namespace carousel::accel
