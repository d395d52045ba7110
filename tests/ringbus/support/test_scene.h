#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "accel/structure/accel.h"
#include "core/config/config.h"
#include "scene/model/scene.h"
#include "tests/ringbus/support/scatter_workload.h"

namespace carousel::ringbus {

scene::Scene builtin_scene(BuiltinScene builtin, std::int64_t triangles, std::int64_t instances,
                           std::int64_t levels = 2);

/// A scene, the rays that are sent into it, and what the reference tracer finds for them at each level of accuracy.
/// Structures are built once a configuration. With `any_hit` rays also have flags.
class TestScene {
 public:
  TestScene(scene::Scene scene, std::uint32_t paths, std::uint8_t bounces, float away = 0.5f,
            const AnyHit* any_hit = nullptr)
      : scene_(std::move(scene)),
        bounds_(scene_.bounds()),
        paths_(paths),
        bounces_(bounces),
        away_(away),
        any_hit_(any_hit) {}

  const accel::Accel& accel(const BvhConfig& bvh, const CullPlanesConfig& planes = {},
                            const AccuracyConfig& accuracy = {});
  ScatterWorkload workload() const;
  std::unique_ptr<Workload> new_workload() const;
  float size() const;  ///< the length of the bounds' diagonal

  /// The reference tracer's answer.
  struct Reference {
    HitsDigest digest;
    std::uint64_t rays = 0;
  };
  const Reference& reference(const AccuracyConfig& accuracy = {});
  const HitsDigest& digest() { return reference().digest; }
  std::uint64_t rays() { return reference().rays; }

 private:
  scene::Scene scene_;
  Aabb bounds_;
  std::uint32_t paths_;
  std::uint8_t bounces_;
  float away_;
  const AnyHit* any_hit_;
  std::map<std::string, std::unique_ptr<accel::Accel>> accels_;
  std::map<std::string, Reference> references_;
};

}  // namespace carousel::ringbus
