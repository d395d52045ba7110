#pragma once

#include <array>

#include "report/sections/visitor.h"

namespace carousel::report {

struct Bounds {
  std::array<double, 3> lo{}, hi{};
};

template <class V>
void describe(V& v, const Bounds& r) {
  v.field("lo", r.lo, "scene units", "least corner");
  v.field("hi", r.hi, "scene units", "greatest corner");
}

struct SceneSummary {
  std::string name;
  std::uint64_t triangles = 0, instanced_triangles = 0, meshes = 0, instances = 0, materials = 0, textures = 0;
  std::uint64_t instances_in_double = 0, instances_not_held = 0;
  std::uint64_t lights = 0, cameras = 0;
  Bounds bounds;
  std::vector<std::string> warnings;
};

template <class V>
void describe(V& v, const SceneSummary& r) {
  v.field("name", r.name, "", "file or built-in scene");
  v.field("triangles", r.triangles, "triangles", "triangles of all meshes");
  v.field("instanced_triangles", r.instanced_triangles, "triangles", "triangles of all instances");
  v.field("meshes", r.meshes, "meshes", "meshes");
  v.field("instances", r.instances, "instances", "placements of meshes");
  v.field("instances_in_double", r.instances_in_double, "instances",
          "those of the instances that are nearly singular, so that rays are brought to their space in 64 bits");
  v.field("instances_not_held", r.instances_not_held, "instances",
          "those of the instances that are so nearly singular that 64 bits do not keep a closed mesh closed either");
  v.field("materials", r.materials, "materials", "materials");
  v.field("textures", r.textures, "textures", "textures");
  v.field("lights", r.lights, "lights", "point, spot and directional lights");
  v.field("cameras", r.cameras, "cameras", "cameras");
  v.section("bounds", r.bounds, "world-space box around all instances");
  v.field("warnings", r.warnings, "", "features of the file that the import ignored");
}

}  // namespace carousel::report
