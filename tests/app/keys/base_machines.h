#pragma once

#include <string>

#include <fmt/format.h>

#include "tests/app/support/program.h"

namespace carousel {

/// The machines from which the test of keys starts. Each is as small as the effects of its keys allow.
enum class BaseMachine {
  kTerrain,
  kInstances,
  kLayers,      ///< non-opaque surfaces, a clearcoat, two cameras
  kFoliage,     ///< surfaces that a texture cuts out
  kProcedural,  ///< procedural primitives
  kCornell,     ///< rays at the edges of boxes, eight copies of each
  kPlanes,      ///< with cull planes
  kBundles,     ///< with bundles
  kNative,      ///< run by the native engine
  kTraffic,     ///< synthetic traffic
  kLinks,       ///< with faults of links
  kOwn,         ///< a primitive with a program
  kGaussians    ///< a cloud of Gaussians
};

/// Instructions that find the way into a ball around the origin, of all classes.
inline std::string ball_program() {
  std::string out;
  for (const char* line :
       {"load r, r",        "mul a, dx, dx",    "fma a, dy, dy, a", "fma a, dz, dz, a", "mul b, ox, dx",
        "fma b, oy, dy, b", "fma b, oz, dz, b", "mul c, ox, ox",    "fma c, oy, oy, c", "fma c, oz, oz, c",
        "mul w, r, r",      "sub c, c, w",      "mul w, a, c",      "mul d, b, b",      "sub d, d, w",
        "load z, 0",        "lt p, d, z",       "stop p",           "sqrt d, d",        "add t, b, d",
        "neg t, t",         "div t, t, a",      "fma x, t, dx, ox", "fma y, t, dy, oy", "fma z, t, dz, oz",
        "hit t, x, y, z"})
    out += fmt::format("      - {}\n", line);
  return out;
}

/// The configuration of a base machine.
inline std::string text(BaseMachine machine) {
  const std::string small =
      "image: {width: 12, height: 8, samples: 1, max_depth: 3}\n"
      "topology: {resources: 4}\n"
      "packets: {rays: 8}\n"
      "collections: {ready: 8, capacity: 16384}\n";
  const std::string slots = "rays: {slots_per_resource: 32}\n";
  const std::string cycle = "engine: {kind: cycle, threads: 1, what_if: false}\n" + small;
  const std::string terrain = "scene: {builtin: terrain, triangles: 600}\n" + slots;
  const std::string instances = "scene: {builtin: instances, instances: 60}\n";
  switch (machine) {
    case BaseMachine::kTerrain:
      return terrain + cycle;
    case BaseMachine::kInstances:
      return instances + slots + cycle;
    case BaseMachine::kLayers:
      return "scene: {file: layers.gltf}\n" + slots + cycle;
    case BaseMachine::kFoliage:
      return "scene: {builtin: foliage, triangles: 60}\n" + slots + cycle;
    case BaseMachine::kProcedural:
      return "scene: {builtin: spheres, triangles: 400, procedural: true}\n" + slots + cycle;
    case BaseMachine::kCornell:
      return "scene: {builtin: cornell}\nworkload: {rays_from: copies.csv}\n" + slots + cycle;
    case BaseMachine::kPlanes:
      return instances + slots + "cull_planes: {count: 2, nodes: all, levels: all}\n" + cycle;
    case BaseMachine::kBundles:
      return instances + "rays: {slots_per_resource: 64}\nbundles: {size: 8}\n" + cycle;
    case BaseMachine::kNative:
      return terrain + "engine: {kind: native, threads: 1}\n" + small;
    case BaseMachine::kTraffic:
      return "engine: {kind: cycle, threads: 1}\ntopology: {resources: 4, link: {depth: 4}}\n"
             "workload: {traffic: {rate: 0.3, packets: 2000}}\n";
    case BaseMachine::kLinks:
      return terrain + "faults: {links: {drop: 0.05, delay: 0.05}}\n" + cycle;
    case BaseMachine::kOwn:  // a ball, which the name of the primitive makes a row's key
      return "scene: {builtin: cornell, objects: [{primitive: NAME, at: [0, 1, 0]}]}\n"
             "primitives:\n  NAME:\n    bounds: {low: [-0.6, -0.6, -0.6], high: [0.6, 0.6, 0.6]}\n"
             "    parameters: {r: 0.5}\n    program:\n" +
             ball_program() + slots + cycle;
    case BaseMachine::kGaussians:
      return "scene: {builtin: gaussians, gaussians: {count: 150, degree: 1}}\n"
             "rays: {slots_per_resource: 32, query: {nearest: 200, buffer: 8}}\n"
             "engine: {kind: cycle, threads: 1, what_if: false}\n"
             "image: {width: 12, height: 8, samples: 1, max_depth: 3}\n"
             "topology: {resources: 4}\npackets: {rays: 8}\n"
             "collections: {ready: 8, capacity: 16384, traversal: ordered}\n";
  }
  return {};
}

/// Writes the scenes and ray files that the machines name.
void write_scenes_and_rays(const Program& program);

}  // namespace carousel
