#include "core/config/load/validate.h"

#include <algorithm>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "core/config/load/bound_rules.h"
#include "core/config/load/feature_rules.h"
#include "core/config/load/memory_rules.h"
#include "core/config/load/network_rules.h"
#include "core/config/load/program_rules.h"
#include "core/config/load/rank_rules.h"
#include "core/config/not_built.h"
#include "core/config/schema.h"
#include "core/text/edit_distance.h"
#include "core/types/effect.h"

namespace carousel {

namespace {

class Rules {
 public:
  Rules(const Config& config, const KeyPositions& positions, const ValidateOptions& options)
      : c(config), options_(options), positions_(positions) {}

  std::vector<ConfigIssue> check() {
    one_scene();
    const config::RuleBreach breach = [this](const std::string& key, std::string message) {
      issue(key, std::move(message));
    };
    config::check_memory(c, breach);
    config::check_frames(c, breach);
    camera_has_a_view();
    raster_needs_a_pinhole();
    all_is_built();
    stored_transform_fits();
    verification_fits();
    config::check_bounds(c, breach);
    config::check_treelets(c, breach);
    shapes_reach_the_resources();
    effects_are_known();
    ordered_needs_strips();
    order_has_a_depth_first_ray();
    config::check_query(c, breach);
    hashed_homes_spill();
    config::check_graph(c, breach);
    config::check_stacks(c, breach);
    config::check_rings(c, breach);
    config::check_own(c, breach);
    config::check_network(c, options_.force, breach);
    config::check_ranks(c, breach);
    config::check_warps(c, breach);
    config::check_programs(c, positions_, issues_);
    sampling_fits();
    search_has_a_frame();
    vary_names_keys();
    return std::move(issues_);
  }

 private:
  void issue(const std::string& key, std::string message) {
    issues_.push_back({positions_.find(key), key, std::move(message)});
  }

  void search_has_a_frame() {
    using Kind = WorkloadConfig::Kind;
    if (!c.area.budget_mm2 || c.area.fit != AreaConfig::Fit::kBest) return;
    const char* const instead = "expected resources, all or refuse, found best";
    if (c.workload.kind == Kind::kTraffic || c.workload.kind == Kind::kMemoryTrace)
      issue("area.fit", fmt::format("splits are compared by rays, and this workload has none; {}", instead));
    if (c.engine.transport != EngineTransport::kLocal)
      issue("area.fit", fmt::format("ranks do not share a search; {}", instead));
  }

  void one_scene() {
    if (c.scene.file.empty() && !c.scene.builtin) {
      if (c.workload.kind == WorkloadConfig::Kind::kTraffic || c.workload.kind == WorkloadConfig::Kind::kMemoryTrace)
        return;  // these meet no scene
      std::string names;
      for (const auto& [scene, name] : kEnumNames<BuiltinScene>)
        names += fmt::format("{}{}", names.empty() ? "" : ", ", name);
      issue("scene", fmt::format("expected a scene: file, or builtin ({})", names));
    }
    if (c.scene.procedural && c.scene.builtin != BuiltinScene::kSpheres)
      issue("scene.procedural", "only the built-in spheres are procedural primitives; expected false, found true");
    if (c.scene.levels != SceneConfig{}.levels && c.scene.builtin != BuiltinScene::kInstances)
      issue("scene.levels",
            fmt::format("only the built-in scene of instances has a depth to choose; expected 2, found {}",
                        c.scene.levels));
    const char* const moment = c.scene.animation ? "scene.animation" : "scene.time";
    if (c.scene.builtin && (c.scene.animation || (c.scene.time && !moves(*c.scene.builtin))))
      issue(moment,
            c.scene.animation
                ? "a built-in scene has no animations; expected scene.time, or a scene.file beside this key"
                : fmt::format("a built-in scene does not move unless it is spheres, terrain or instances; expected one "
                              "of these, or a scene.file beside this key; found {}",
                              enum_name(*c.scene.builtin)));
    if (c.scene.animation && c.scene.time)
      issue("scene.time", "scene.animation has a time of its own; expected one of the two, found both");
    if (c.scene.animation && c.scene.animation->name.empty())
      issue("scene.animation.name", "expected the name or the index of an animation of the file");
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
    // The sine of the angle between up and view must be larger: look_at() needs more than roundings.
    constexpr double kLeastSine = 1e-6;
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
    return properties_of(c.topology).has_packets && c.topology.resources > 1 && c.collections.home != Home::kLocal &&
           c.workload.kind != WorkloadConfig::Kind::kTraffic && c.workload.kind != WorkloadConfig::Kind::kMemoryTrace;
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

  void verification_fits() {
    if (c.verify == Verify::kEffects && c.shading.effects.choice != ShadingConfig::Effects::Choice::kAuto)
      issue("verify",
            "effects compares the effects that the scene calls for with all effects; expected shading.effects: auto");
    if (c.verify == Verify::kEffects && c.workload.kind == WorkloadConfig::Kind::kRaysFrom)
      issue("verify",
            "a list of rays is not shaded, so effects change nothing; expected none or reference, found effects");
    if (c.verify == Verify::kEffects && c.workload.kind == WorkloadConfig::Kind::kPlugin)
      issue("verify", "the rays of a plugin have no effects of light; expected none or reference, found effects");
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

  void order_has_a_depth_first_ray() {
    if (c.collections.order == ChildOrder::kNearest || !properties_of(c.topology).has_packets ||
        c.bvh.treelets.bytes > 0)
      return;
    if (c.collections.traversal == Traversal::kSpread)
      issue("collections.order",
            "traversal: spread takes a ray into all children at once; expected nearest, or traversal: ordered or "
            "treelet, found stored");
    if (c.collections.traversal == Traversal::kTreelet && c.engine.kind == EngineKind::kNative)
      issue("collections.order",
            "the native engine takes a ray through a treelet nearest first; expected nearest, or engine.kind: cycle, "
            "found stored");
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
    if (c.workload.kind == Kind::kPlugin)
      issue("sampling.fraction",
            fmt::format("the rays of a plugin are not drawn from; expected 1, found {}", c.sampling.fraction));
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
