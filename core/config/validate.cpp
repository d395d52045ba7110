#include "core/config/validate.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "core/config/edit_distance.h"
#include "core/config/memory_rules.h"
#include "core/config/network_rules.h"
#include "core/config/not_built.h"
#include "core/config/schema.h"
#include "core/types/effect.h"

namespace carousel {

namespace {

class Rules {
 public:
  Rules(const Config& config, const KeyPositions& positions, const ValidateOptions& options)
      : c(config), options_(options), positions_(positions) {}

  std::vector<ConfigIssue> check() {
    one_scene();
    config::check_memory(c, [this](const std::string& key, std::string message) { issue(key, std::move(message)); });
    camera_has_a_view();
    raster_needs_a_pinhole();
    all_is_built();
    stored_transform_fits();
    planes_and_bundles_fit();
    levels_fit();
    shapes_reach_the_resources();
    effects_are_known();
    ordered_needs_strips();
    query_needs_a_file();
    hashed_homes_spill();
    config::check_network(c, options_.force,
                          [this](const std::string& key, std::string message) { issue(key, std::move(message)); });
    sampling_fits();
    vary_names_keys();
    return std::move(issues_);
  }

 private:
  void issue(const std::string& key, std::string message) {
    issues_.push_back({positions_.find(key), key, std::move(message)});
  }

  void query_needs_a_file() {
    if (c.rays.query != Query::kClosest && c.workload.kind != WorkloadConfig::Kind::kRaysFrom)
      issue("rays.query",
            "a picture's shaders say which hits they look for; expected closest, or workload: {rays_from: FILE}");
  }

  void one_scene() {
    if (c.scene.file.empty() && !c.scene.builtin) {
      if (c.workload.kind == WorkloadConfig::Kind::kTraffic || c.workload.kind == WorkloadConfig::Kind::kMemoryTrace)
        return;  // these meet no scene
      issue("scene", "expected a scene: file, or builtin (cornell, spheres, terrain, instances, sliver)");
    }
    if (c.scene.procedural && c.scene.builtin != BuiltinScene::kSpheres)
      issue("scene.procedural", "only the built-in spheres are procedural primitives; expected false, found true");
    if (c.scene.levels != SceneConfig{}.levels && c.scene.builtin != BuiltinScene::kInstances)
      issue("scene.levels",
            fmt::format("only the built-in scene of instances has a depth to choose; expected 2, found {}",
                        c.scene.levels));
    if (!c.scene.file.empty() && c.scene.builtin)
      issue("scene.builtin",
            "expected either file or builtin, found both; another scene takes the place of both with --set "
            "'scene={file: NAME}'");
  }

  void camera_has_a_view() {
    const CameraConfig& camera = c.camera;
    if (camera.eye && !camera.target)
      issue("camera.eye", "a camera of your own looks at a point; expected camera.target beside camera.eye");
    if (camera.target && !camera.eye)
      issue("camera.target", "a camera of your own has a place; expected camera.eye beside camera.target");
    if (!camera.eye || !camera.target) {
      if (camera.up != CameraConfig{}.up && !camera.eye && !camera.target)
        issue("camera.up",
              "only a camera of your own is turned; expected camera.eye and camera.target beside camera.up");
      return;
    }
    const DVec3 view = DVec3(*camera.target) - DVec3(*camera.eye), up(camera.up);
    if (glm::dot(view, view) == 0) return issue("camera.target", "expected another point than camera.eye");
    if (glm::dot(up, up) == 0) return issue("camera.up", "expected a direction, found a vector of length 0");
    const DVec3 aside = glm::cross(view, up);
    constexpr double kLeastSine = 1e-6;  // of the angle between up and the view; look_at() needs more than roundings
    if (glm::dot(aside, aside) <= kLeastSine * kLeastSine * glm::dot(view, view) * glm::dot(up, up))
      issue("camera.up", "the camera looks along this direction; expected one that is not parallel to the view");
  }

  void raster_needs_a_pinhole() {
    if (c.primary != Primary::kRaster) return;
    if (c.camera.aperture > 0)
      issue("camera.aperture",
            fmt::format("primary: raster needs a pinhole; expected 0, or primary: rays, found {}", c.camera.aperture));
    if (c.workload.kind != WorkloadConfig::Kind::kRays)
      issue("primary", "this workload has no camera; expected rays, found raster");
  }

  bool cycle() const { return c.engine.kind == EngineKind::kCycle; }

  void all_is_built() {
    for (config::Refusal& refusal : config::refusals(c)) issue(refusal.key, std::move(refusal.message));
  }

  // The shapes reach a resource within packets, or it reads them itself.
  void shapes_reach_the_resources() {
    if (!cycle()) return;
    const bool data = c.packets.carry == PacketCarry::kData;
    if (data && c.memory.fetch == MemoryConfig::Fetch::kResource)
      issue("memory.fetch",
            "a packet that carries its shapes' data gets them from its issuer; expected packet, found "
            "resource");
    if (!data && c.memory.fetch == MemoryConfig::Fetch::kPacket && packets_travel())
      issue("memory.fetch",
            "packets that carry a reference bring no shapes along; expected resource, or packets.carry: data, whose "
            "bytes are charged on every hop; found packet");
  }
  bool packets_travel() const {
    return c.topology.shape != TopologyShape::kIndependent && c.topology.resources > 1 &&
           c.collections.home != Home::kLocal && c.workload.kind != WorkloadConfig::Kind::kTraffic &&
           c.workload.kind != WorkloadConfig::Kind::kMemoryTrace;
  }

  void stored_transform_fits() {
    using Data = AccuracyConfig::InstanceData;
    const AccuracyConfig& a = c.accuracy;
    if (!a.instance_data) return;
    const bool one_matrix = a.transform == TransformLevel::kInverseMatrix;
    if (*a.instance_data == (one_matrix ? Data::kRt : Data::kInverse))
      issue("accuracy.instance_data",
            fmt::format("transform: {} {}; expected forward or {}, found {}", enum_name(a.transform),
                        one_matrix ? "has the translation multiplied in" : "subtracts the translation first",
                        one_matrix ? "inverse" : "rt", enum_name(*a.instance_data)));
    const bool forward = *a.instance_data == Data::kForward;
    if (a.invert && (*a.invert == AccuracyConfig::Invert::kVisit) != forward)
      issue("accuracy.invert", fmt::format("instance_data: {} {}; expected {}, found {}", enum_name(*a.instance_data),
                                           forward ? "stores nothing inverted" : "is stored inverted",
                                           forward ? "visit" : "build", enum_name(*a.invert)));
  }

  void planes_and_bundles_fit() {
    if (c.verify == Verify::kEffects && c.shading.effects.choice != ShadingConfig::Effects::Choice::kAuto)
      issue("verify",
            "effects compares the effects that the scene calls for with all effects; expected shading.effects: auto");
    if (c.verify == Verify::kEffects && c.workload.kind == WorkloadConfig::Kind::kRaysFrom)
      issue("verify",
            "a list of rays is not shaded, so effects change nothing; expected none or reference, found effects");
    if (c.bvh.elements == BvhConfig::Elements::kSpheres) {
      constexpr std::string_view what = "{} need boxes to be tested with; expected boxes, or {}; found spheres";
      if (c.cull_planes.count > 0) issue("bvh.elements", fmt::format(what, "cull planes", "cull_planes.count: 0"));
      if (c.bundles.size > 0) issue("bvh.elements", fmt::format(what, "bundles", "bundles.size: 0"));
    }
    if (c.cull_planes.count > 0) planes_need_bounded_errors();
    if (c.bundles.size > 0) bundles_fit();
  }

  // Nodes of a group are tested with a slack of each ray's own (accel/structure/group_placement.h).
  void levels_fit() {
    if (c.bvh.levels == 2) return;
    constexpr std::string_view what = "{} not tested within groups of instances; expected 2, or {}; found {}";
    if (c.bundles.size > 0) issue("bvh.levels", fmt::format(what, "bundles are", "bundles.size: 0", c.bvh.levels));
    if (c.bvh.elements == BvhConfig::Elements::kSpheres)
      issue("bvh.levels", fmt::format(what, "spheres are", "bvh.elements: boxes", c.bvh.levels));
    if (c.cull_planes.count > 0 && c.cull_planes.levels != CullPlanesConfig::Levels::kBlas)
      issue("bvh.levels",
            fmt::format(what, "cull planes above the instances are", "cull_planes.levels: blas", c.bvh.levels));
  }

  // A bundle has one owner, which tests all of its rays at one visit.
  void bundles_fit() {
    const BundlesConfig& b = c.bundles;
    if (b.size == 1) issue("bundles.size", "expected 2 rays or more, or 0 for none; found 1");
    if (b.size > c.rays.slots_per_resource)
      issue("bundles.size",
            fmt::format("a bundle's rays live in one resource; expected at most rays.slots_per_resource = "
                        "{}, found {}",
                        c.rays.slots_per_resource, b.size));
    if (b.strict && b.order == BundlesConfig::Order::kAnyHitOnly)
      issue("bundles.strict",
            "any_hit_only takes bundles along where only some of their rays hit; expected false, found true");
    constexpr std::string_view without = ", or bundles.size: 0";
    if (c.collections.traversal == Traversal::kOrdered)
      issue("collections.traversal",
            fmt::format("rays of a bundle go several ways at once; expected spread or treelet, found ordered{}",
                        without));
    if (c.packets.shapes == PacketShapes::kSingle)
      issue("packets.shapes",
            fmt::format("a bundle is tested against a whole strip; expected strip, found single{}", without));
    if (c.rays.placement == Placement::kFirstTaker || c.rays.placement == Placement::kAddressed)
      issue("rays.placement",
            fmt::format("bundles are made before their rays have slots; expected balanced or round_robin, "
                        "found {}{}",
                        enum_name(c.rays.placement), without));
    if (c.topology.shape == TopologyShape::kIndependent)
      issue("topology.shape",
            fmt::format("independent resources trace single rays; expected a ring or another network, "
                        "found independent{}",
                        without));
    if (std::bit_width(static_cast<std::uint64_t>(c.topology.resources - 1)) +
            std::bit_width(static_cast<std::uint64_t>(2 * c.rays.slots_per_resource)) >
        32)
      issue("rays.slots_per_resource",
            fmt::format("IDs of 32 bits name bundles as well; expected fewer slots than {}{}",
                        c.rays.slots_per_resource, without));
  }

  // The slack of the plane test covers the rounding of these kernels. For the others there is no bound.
  void planes_need_bounded_errors() {
    if (c.accuracy.triangle != TriangleLevel::kWatertight && c.accuracy.triangle != TriangleLevel::kExact)
      issue("accuracy.triangle", fmt::format("cull planes could lose hits of {}; expected watertight or exact, or "
                                             "cull_planes.count: 0",
                                             enum_name(c.accuracy.triangle)));
    if (c.accuracy.box != BoxLevel::kConservative)
      issue("accuracy.box", fmt::format("cull planes go with conservative boxes; expected conservative, found {}, or "
                                        "cull_planes.count: 0",
                                        enum_name(c.accuracy.box)));
    if (c.cull_planes.levels != CullPlanesConfig::Levels::kBlas &&
        c.accuracy.transform == TransformLevel::kInverseMatrix)
      issue("accuracy.transform",
            fmt::format("cull planes above the instances could lose hits of {}; expected two_step, "
                        "two_step_double or transpose_if_rotation, or cull_planes.levels: blas",
                        enum_name(c.accuracy.transform)));
    if (c.cull_planes.object == CullPlanesConfig::Object::kOrientedBox) {
      if (c.cull_planes.count < 6)
        issue("cull_planes.count",
              fmt::format("an oriented box has six faces; expected 6 or more, found {}, or cull_planes.object: planes",
                          c.cull_planes.count));
      if (c.cull_planes.shared_normals)
        issue("cull_planes.shared_normals",
              "each oriented box has axes of its own; expected false, found true, or cull_planes.object: planes");
    }
    if (c.cull_planes.depth.first > c.cull_planes.depth.last)
      issue("cull_planes.depth.first",
            fmt::format("no node has such a depth; expected at most cull_planes.depth.last = {}, found {}",
                        c.cull_planes.depth.last, c.cull_planes.depth.first));
  }

  void effects_are_known() {
    const std::vector<std::string> known(kEffectNames.begin(), kEffectNames.end());
    for (std::size_t i = 0; i < c.shading.effects.names.size(); ++i) {
      const std::string& name = c.shading.effects.names[i];
      if (effect_named(name)) continue;
      const auto near = nearest_name(name, known);
      issue(fmt::format("shading.effects.{}", i),
            fmt::format("expected the name of an effect, found '{}'{}", name,
                        near ? fmt::format("; did you mean '{}'?", *near)
                             : fmt::format("; known are {}", fmt::join(known, ", "))));
    }
  }

  void ordered_needs_strips() {
    if (c.collections.traversal == Traversal::kOrdered && c.packets.shapes != PacketShapes::kStrip)
      issue("packets.shapes", "traversal: ordered sorts the hits of a whole strip; expected strip, found single");
  }

  void hashed_homes_spill() {
    if (c.collections.home == Home::kHash && c.collections.when_full != WhenFull::kSpill)
      issue("collections.when_full",
            "home: hash can fill one resource with another's collections and stop; expected spill, found "
            "reserve");
  }

  // A sample stands for a frame of many alike parts.
  void sampling_fits() {
    if (c.sampling.fraction >= 1) return;
    using Kind = WorkloadConfig::Kind;
    constexpr std::string_view whole = ", or sampling.fraction: 1";
    if (c.workload.kind == Kind::kTraffic || c.workload.kind == Kind::kMemoryTrace)
      issue("sampling.fraction",
            fmt::format("this workload has no rays to draw from; expected 1, found {}", c.sampling.fraction));
    if (c.workload.kind == Kind::kRaysFrom && c.sampling.strata)
      issue("sampling.strata",
            fmt::format("the rays of a list are drawn in runs of 64, a run a stratum; expected auto{}; "
                        "found {}",
                        whole, *c.sampling.strata));
    using Fault = FaultsConfig::Resource::Kind;
    const Fault fault = c.faults.resource.kind;
    if (fault == Fault::kPause || fault == Fault::kStop)
      issue("faults.resource.kind",
            fmt::format(
                "happens once in a frame, so that a sample says nothing about it; expected none or slow{}; found {}",
                whole, enum_name(fault)));
  }

  void vary_names_keys() {
    if (c.vary.empty()) return;
    const std::vector<std::string>& known = config::config_key_paths();
    for (const auto& [keys, values] : c.vary) {
      for (std::size_t begin = 0; begin <= keys.size();) {  // several keys vary together: "a.b,c.d"
        const std::size_t end = std::min(keys.find(',', begin), keys.size());
        const std::string key = keys.substr(begin, end - begin);
        begin = end + 1;
        if (std::find(known.begin(), known.end(), key) != known.end()) continue;
        const auto near = nearest_name(key, known);
        issues_.push_back({positions_.find("vary." + keys), "vary." + keys,
                           fmt::format("unknown key '{}'{}", key, near ? "; did you mean '" + *near + "'?" : "")});
      }
    }
  }

  const Config& c;
  const ValidateOptions& options_;
  const KeyPositions& positions_;
  std::vector<ConfigIssue> issues_;
};

}  // namespace

std::vector<ConfigIssue> validate_config(const Config& config, const KeyPositions& positions,
                                         const ValidateOptions& options) {
  return Rules(config, positions, options).check();
}

}  // namespace carousel
