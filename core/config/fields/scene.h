#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/config/fields/field.h"
#include "core/types/vec.h"

namespace carousel {

enum class BuiltinScene { kCornell, kSpheres, kTerrain, kInstances, kSliver, kFoliage, kGaussians };
template <>
inline constexpr auto kEnumNames<BuiltinScene> = [] {
  using enum BuiltinScene;
  return names<BuiltinScene>({{kCornell, "cornell"},
                              {kSpheres, "spheres"},
                              {kTerrain, "terrain"},
                              {kInstances, "instances"},
                              {kSliver, "sliver"},
                              {kFoliage, "foliage"},
                              {kGaussians, "gaussians"}});
}();

/// True for a generated scene that is another one at another time.
constexpr bool moves(BuiltinScene scene) {
  return scene == BuiltinScene::kSpheres || scene == BuiltinScene::kTerrain || scene == BuiltinScene::kInstances;
}

enum class ScenePlacement { kReplicated, kPartitioned };
template <>
inline constexpr auto kEnumNames<ScenePlacement> = [] {
  using enum ScenePlacement;
  return names<ScenePlacement>({{kReplicated, "replicated"}, {kPartitioned, "partitioned"}});
}();

struct SkyConfig {
  Vec3 color{0.6f, 0.7f, 0.9f};
  float strength = 1;
  std::string file{};
  float rotation = 0;
};

struct AnimationConfig {
  std::string name;
  float time = 0;
};

struct ProgramParameters {
  std::map<std::string, double> values;  ///< by name
};

/// A program of shader workers.
struct ShaderConfig {
  ProgramParameters parameters;
  std::vector<std::string> program;  ///< an instruction each
};

struct ShadersConfig {
  std::map<std::string, ShaderConfig> named;
};

/// The time of an instruction by its class, from its issue until its result may be read, and programs by name.
struct ProgramsConfig {
  std::int64_t simple_cycles = 4, product_cycles = 4, divide_cycles = 16, branch_cycles = 2, texture_cycles = 8,
               trace_cycles = 4;
  ShadersConfig shaders;
};

struct PrimitiveBounds {
  Vec3 low{-1}, high{1};
};

/// A primitive whose hits an intersection program finds (core/program).
struct PrimitiveConfig {
  PrimitiveBounds bounds;
  double offset = 1e-4;
  ProgramParameters parameters;
  std::vector<std::string> program;  ///< an instruction each
};

struct PrimitivesConfig {
  std::map<std::string, PrimitiveConfig> named;
};

/// A primitive of PrimitivesConfig where it stands in the scene.
struct SceneObject {
  static constexpr std::string_view kRequired = "primitive";
  static constexpr std::string_view kRowPath = "";

  std::string primitive;
  Vec3 at{0}, turn{0};
  float scale = 1;
  Vec3 color{0.8f};
  float metallic = 0, roughness = 0.5f;
};

/// The Gaussians of a scene: a file's (glTF, PLY) or those of the built-in cloud.
struct GaussiansConfig {
  enum class Geometry { kEllipsoids, kTriangles } geometry = Geometry::kEllipsoids;
  std::int64_t count = 1000;
  std::optional<std::int64_t> degree;  ///< absent: all that a file has, or 0 in the built-in cloud
  float radius = 3;
  float least_alpha = 0;
  float opaque_below = 0.001f;
};

template <>
inline constexpr auto kEnumNames<GaussiansConfig::Geometry> = [] {
  using enum GaussiansConfig::Geometry;
  return names<GaussiansConfig::Geometry>({{kEllipsoids, "ellipsoids"}, {kTriangles, "triangles"}});
}();

struct SceneConfig {
  std::string file;
  std::optional<BuiltinScene> builtin;
  bool procedural = false;
  std::int64_t triangles = 20000;
  std::int64_t instances = 1000;
  std::int64_t levels = 2;
  std::int64_t seed = 1;
  std::int64_t camera = 0;
  std::optional<float> time;  ///< of all animations; absent, as `animation` is: the base pose, or 0
  std::optional<AnimationConfig> animation;
  std::optional<SkyConfig> sky;
  std::vector<SceneObject> objects;
  GaussiansConfig gaussians;
  ScenePlacement placement = ScenePlacement::kReplicated;
  std::int64_t quantise = 0;  ///< bits; 0: vertices stay where they are
};

namespace config {

template <class V>
void describe(V& v, SkyConfig& c) {
  v.field("color", c.color, RealRange{0, 1e6}, "linear RGB", "The colour of the sky, where it has no map.");
  v.field("strength", c.strength, RealRange{0, 1e6}, "", "A factor on the colour or the map. With 0 the sky is black.");
  v.field("file", c.file, "",
          "An environment map, in longitude and latitude: a Radiance file (.hdr) or an OpenEXR file. Its path is "
          "relative as that of scene.file is. The middle of the picture is seen along -Z, its upper edge along +Y.");
  v.field("rotation", c.rotation, RealRange{-360, 360}, "degrees",
          "The map is turned about +Y, counter-clockwise as seen from above.");
}

inline constexpr RealRange kMoment{0, 1e9};

template <class V>
void describe(V& v, AnimationConfig& c) {
  v.field("name", c.name, "", "The name of the animation, or its index in the file.");
  v.field("time", c.time, kMoment, "seconds", "The time at which it is shown. Times after its end are its end.");
}

inline constexpr IntRange kInstructionCycles{1, 255};
inline constexpr RealRange kModelSpace{-1e6, 1e6};

template <class V>
void describe(V& v, ProgramParameters& c) {
  v.others(c.values, RealRange{-1e30, 1e30}, "", "A number that the program loads by this name.");
}

template <class V>
void describe(V& v, ShaderConfig& c) {
  v.section("parameters", c.parameters, "Numbers that the program loads.");
  v.texts("program", c.program, "The instructions, one a line (docs/reference/instructions.md).");
}

template <class V>
void describe(V& v, ShadersConfig& c) {
  v.members(c.named, "A program of this name, which shading.program names.");
}

template <class V>
void describe(V& v, ProgramsConfig& c) {
  v.field("simple_cycles", c.simple_cycles, kInstructionCycles, "cycles",
          "The time from a sum, a comparison or a move until its result may be read. A unit issues one instruction a "
          "cycle, in order, when the operands are there.");
  v.field("product_cycles", c.product_cycles, kInstructionCycles, "cycles", "Likewise for mul and fma.");
  v.field("divide_cycles", c.divide_cycles, kInstructionCycles, "cycles", "Likewise for div and sqrt.");
  v.field("branch_cycles", c.branch_cycles, kInstructionCycles, "cycles",
          "The time from an if, else, loop, end, break or stop until the next instruction is issued.");
  v.field("texture_cycles", c.texture_cycles, kInstructionCycles, "cycles",
          "The time in which a shader worker filters the texels of a texture, from when they have come.");
  v.field("trace_cycles", c.trace_cycles, kInstructionCycles, "cycles",
          "The time in which a shader worker writes a new ray, until the next instruction is issued.");
  v.section("shaders", c.shaders, "Programs of shader workers.");
}

template <class V>
void describe(V& v, PrimitiveBounds& c) {
  v.field("low", c.low, kModelSpace, "model units", "The lower corner of the box. A hit outside of the box is none.");
  v.field("high", c.high, kModelSpace, "model units", "The upper corner.");
}

template <class V>
void describe(V& v, PrimitiveConfig& c) {
  v.section("bounds", c.bounds, "The box around the primitive, in its own space.");
  v.field("offset", c.offset, RealRange{0, 1e6}, "model units",
          "The error of a hit along its normal. Rays that leave the surface start so far away from it.");
  v.section("parameters", c.parameters, "Numbers that the program loads.");
  v.texts("program", c.program, "The instructions, one a line (docs/reference/instructions.md).");
}

template <class V>
void describe(V& v, PrimitivesConfig& c) {
  v.members(c.named, "A primitive of this name, which scene.objects places.");
}

template <class V>
void describe(V& v, SceneObject& c) {
  v.field("primitive", c.primitive, "", "The primitive, a name of `primitives`.");
  v.field("at", c.at, kModelSpace, "scene units", "The place of the origin of its space.");
  v.field("turn", c.turn, RealRange{-360, 360}, "degrees", "It is turned about x, then about y, then about z.");
  v.field("scale", c.scale, RealRange{0, 1e6, true}, "", "The size of its unit in the scene.");
  v.field("color", c.color, RealRange{0, 1}, "linear RGB", "The base colour of its material.");
  v.field("metallic", c.metallic, RealRange{0, 1}, "", "The share of metal in its material.");
  v.field("roughness", c.roughness, RealRange{0, 1}, "", "The roughness of its material.");
}

template <class V>
void describe(V& v, GaussiansConfig& c) {
  v.choice("geometry", c.geometry,
           "The shapes that rays are tested against: an instance of one unit sphere for each Gaussian, or 20 triangles "
           "around it.");
  v.field("count", c.count, IntRange{1, 10'000'000}, "Gaussians", "The number of Gaussians of the built-in cloud.");
  v.field_or_auto("degree", c.degree, IntRange{0, 3}, "",
                  "The highest degree of the harmonics that say how a Gaussian's colour depends on the direction from "
                  "which it is seen. Those of a file above it are left out. auto: all that a file has, and 0 in the "
                  "built-in cloud.");
  v.field("radius", c.radius, RealRange{0.1, 10}, "standard deviations",
          "A Gaussian ends at this distance from its mean.");
  v.field("least_alpha", c.least_alpha, RealRange{0, 0.5}, "",
          "A Gaussian ends nearer to its mean where it would take less than this share of the light. 0: it does not.");
  v.field("opaque_below", c.opaque_below, RealRange{0, 0.5}, "",
          "A ray looks for no more Gaussians once less than this share of the light behind them reaches it.");
}

template <class V>
void describe(V& v, SceneConfig& c) {
  v.field("file", c.file, "",
          "A file of glTF, or of OBJ, FBX, PLY, STL, COLLADA and other formats. Its path is relative to the config's "
          "folder, then to the working one.");
  v.choice("builtin", c.builtin, "A generated scene. A config gives either this or a file.");
  v.field("procedural", c.procedural, "",
          "The built-in spheres are procedural primitives, as many as there would be triangles.");
  v.field("triangles", c.triangles, IntRange{1, 100'000'000}, "triangles",
          "The approximate number of triangles of the built-in spheres, terrain, sliver and foliage.");
  v.field("instances", c.instances, IntRange{1, 10'000'000}, "instances",
          "The number of instances of the built-in scene of instances.");
  v.field("levels", c.levels, IntRange{2, 8}, "levels",
          "With more than 2 the built-in scene of instances consists of groups, within groups down to this depth, each "
          "of them placed many times.");
  v.field("seed", c.seed, kSeed, "", "The seed of every built-in scene but cornell.");
  v.field("camera", c.camera, IntRange{0, 65535}, "", "The index of the camera among those of the scene.");
  v.field_or_auto("time", c.time, kMoment, "seconds",
                  "The moment at which a file is shown that has animations, skins or morph targets. All animations "
                  "that move different nodes are played. With auto the file is shown in its base pose, in which "
                  "animations, skins and morph targets are ignored. The built-in spheres go round in circles, the "
                  "terrain has waves, and the instances turn about the middle; auto is 0.");
  v.section("animation", c.animation,
            "The one animation that is played, in place of time. Skins and morph targets follow it.");
  v.section(
      "sky", c.sky,
      "A sky of one colour, or of an environment map. Without this key a built-in scene has its own sky, and a file "
      "has the default.");
  v.list("objects", c.objects, "Primitives of `primitives` that stand in the scene beside what it has.");
  v.section("gaussians", c.gaussians, "Gaussians that the scene consists of, if any.");
  v.choice("placement", c.placement,
           "With engine.transport mpi each rank has the whole acceleration structure, or with partitioned that of its "
           "share of the meshes; packets then start where their shape is, and bring it along.");
  v.field(
      "quantise", c.quantise, IntRange{0, 24}, "bits",
      "The vertices of each mesh are moved to the nearest points of a grid with at most 2 to this power steps along "
      "the longest side of the mesh's box. With 0 they stay where they are.");
}

}  // namespace config
}  // namespace carousel
