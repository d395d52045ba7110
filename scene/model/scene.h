#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/program/program.h"
#include "core/types/aabb.h"
#include "core/types/ids.h"
#include "core/types/vec.h"
#include "scene/model/gaussians.h"
#include "scene/model/pose_choice.h"
#include "scene/model/sky_map.h"

namespace carousel::scene {

/// Decoded pixels, row-major from the top left, 4 bytes RGBA each, as stored in the file (not linearised).
struct Image {
  std::string name;
  std::uint32_t width = 0, height = 0;
  std::vector<std::uint8_t> rgba;
};

enum class Wrap : std::uint8_t { kRepeat, kClamp, kMirror };

/// An image with its sampler. The use of an image, not the image, decides if its RGB channels are sRGB-encoded.
struct Texture {
  ImageId image;
  Wrap wrap_u = Wrap::kRepeat, wrap_v = Wrap::kRepeat;
  bool linear_filter = true;
};

/// A texture as a material uses it.
struct TextureUse {
  TextureId texture;
  std::uint8_t uv_set = 0;         ///< 0 or 1
  Vec2 offset{0, 0}, scale{1, 1};  ///< KHR_texture_transform: uv' = offset + R(rotation) * (scale * uv)
  float rotation = 0;              ///< radians; R(a) (u, v) = (cos a u + sin a v, -sin a u + cos a v)
};

enum class AlphaMode : std::uint8_t { kOpaque, kMask, kBlend };

/// glTF metallic-roughness with the layers of its extensions, whose defaults are those of a file without them: a layer
/// of weight 0 is not there. Colours are linear.
struct Material {
  std::string name;
  Vec4 base_color{1};  ///< times the texture (sRGB) and the vertex colour
  std::optional<TextureUse> base_color_texture;
  float metallic = 1, roughness = 1;
  std::optional<TextureUse> metallic_roughness_texture;  ///< G roughness, B metallic, linear
  Vec3 emissive{0};                                      ///< with emissive_strength multiplied in
  std::optional<TextureUse> emissive_texture;            ///< sRGB
  std::optional<TextureUse> normal_texture;              ///< tangent space, linear
  float normal_scale = 1;
  AlphaMode alpha_mode = AlphaMode::kOpaque;
  float alpha_cutoff = 0.5f;
  bool double_sided = false;
  bool unlit = false;

  float ior = 1.5f;      ///< KHR_materials_ior; 0: infinite, or at least 1
  struct Transmission {  ///< KHR_materials_transmission
    float weight = 0;
    std::optional<TextureUse> texture;  ///< R, linear
  } transmission;
  struct Volume {                                 ///< KHR_materials_volume
    float thickness = 0;                          ///< 0: a thin wall, which does not refract
    std::optional<TextureUse> thickness_texture;  ///< G, linear; rays measure the way themselves
    Vec3 attenuation_color{1};                    ///< share of the light left after attenuation_distance
    float attenuation_distance = std::numeric_limits<float>::infinity();  ///< scene units
  } volume;
  struct Specular {  ///< KHR_materials_specular
    float weight = 1;
    Vec3 color{1};
    std::optional<TextureUse> texture;        ///< A, linear
    std::optional<TextureUse> color_texture;  ///< sRGB
  } specular;
  struct Clearcoat {  ///< KHR_materials_clearcoat
    float weight = 0, roughness = 0;
    std::optional<TextureUse> texture;            ///< R, linear
    std::optional<TextureUse> roughness_texture;  ///< G, linear
    std::optional<TextureUse> normal_texture;     ///< without: the surface's own normal, unbent
    float normal_scale = 1;
  } clearcoat;
  struct Sheen {  ///< KHR_materials_sheen
    Vec3 color{0};
    float roughness = 0;
    std::optional<TextureUse> color_texture;      ///< sRGB
    std::optional<TextureUse> roughness_texture;  ///< A, linear
  } sheen;
  struct Iridescence {  ///< KHR_materials_iridescence
    float weight = 0, ior = 1.3f;
    float thickness_min = 100, thickness_max = 400;  ///< nanometres
    std::optional<TextureUse> texture;               ///< R, linear
    std::optional<TextureUse> thickness_texture;     ///< G, linear
  } iridescence;
  struct Anisotropy {  ///< KHR_materials_anisotropy
    float strength = 0;
    float rotation = 0;                 ///< radians, counter-clockwise from the tangent
    std::optional<TextureUse> texture;  ///< RG direction, B strength, linear
  } anisotropy;
};

/// Stands for a sphere, whose hits need no program.
inline constexpr std::uint32_t kNoProgram = 0xffffffffu;

/// A sphere as such, not triangulated, in model space; an instance may stretch it to an ellipsoid. Or a primitive whose
/// hits a program finds within a box: then `center` and `radius` are those of a sphere around the box.
struct Sphere {
  Vec3 center{0};
  float radius = 1;  ///< > 0, finite
  MaterialId material{};
  std::uint32_t program = kNoProgram;  ///< in Scene::programs
  Vec3 half{0};                        ///< with a program: from the middle of the box to its sides

  /// From the middle to the sides of the box.
  Vec3 reach() const { return program == kNoProgram ? Vec3(radius) : half; }
};

/// Triangles of one glTF mesh, its primitives concatenated in order, then spheres: `primitive` in a hit counts
/// through the triangles first, so sphere i is primitive triangle_count() + i.
struct Mesh {
  std::string name;
  std::vector<Vec3> positions;                 ///< finite
  std::vector<Vec3> normals;                   ///< empty (flat shading), or one unit vector a position
  std::vector<Vec2> uv0, uv1;                  ///< empty, or one a position
  std::vector<Vec4> colors;                    ///< empty, or one a position; linear RGBA
  std::vector<std::uint32_t> indices;          ///< 3 a triangle, each < positions.size()
  std::vector<MaterialId> triangle_materials;  ///< one a triangle
  std::vector<Sphere> spheres;

  std::size_t triangle_count() const { return indices.size() / 3; }
};

/// world = linear * model + translation. Entries are finite. Composed in double, rounded to float once.
struct Affine {
  Mat3 linear{1.0f};
  Vec3 translation{0};
};

/// Stands for the world, where a group's placement would be named.
inline constexpr std::uint32_t kNoPlacement = 0xffffffffu;

/// One placement of a mesh; the index of an instance in Scene::instances is what hits name. Order: depth-first
/// node order of the default scene, EXT_mesh_gpu_instancing expanded in place. A singular linear part is
/// allowed here; accel bakes such instances into world space.
struct Instance {
  MeshId mesh;
  Affine world_from_model;
  std::uint32_t placement = kNoPlacement;  ///< in Scene::placements: of the innermost group that it belongs to
  std::uint32_t member = 0;                ///< index of the member in that group
};

/// Instances and groups that are placed together. A group stands in Scene::groups before those that
/// have it for a member.
struct Group {
  struct Member {
    bool is_group = false;
    std::uint32_t index = 0;  ///< in Scene::groups, or of a mesh
    friend bool operator==(const Member&, const Member&) = default;
  };
  std::vector<Member> members;  ///< two at least, in the order of the instances
};

/// One placement of a group, in the world or in another group, which is placed before it. Members of one group stand in
/// the same way in each of its placements, but for the rounding of the composed transforms.
struct GroupPlacement {
  std::uint32_t group = 0;              ///< in Scene::groups
  Affine world_from_group;              ///< composed as Instance::world_from_model is; may be singular
  std::uint32_t parent = kNoPlacement;  ///< in Scene::placements
  std::uint32_t member = 0;             ///< index of the member in the parent's group
};

/// A node of the file that has a name and shows something: its instances, and those of all nodes below it.
struct NamedNode {
  std::string name;
  std::size_t first_instance = 0, instances = 0;  ///< in Scene::instances, one at least
};

struct Camera {
  std::string name;
  enum class Projection : std::uint8_t { kPerspective, kOrthographic } projection = Projection::kPerspective;
  Vec3 position{0};
  /// Orthonormal, right-handed: the camera looks along -back; up is towards the top of the image.
  Vec3 right{1, 0, 0}, up{0, 1, 0}, back{0, 0, 1};
  float yfov = 0.8f;                  ///< radians, perspective
  std::optional<float> aspect_ratio;  ///< perspective; informative, the image's own aspect is used
  float xmag = 1, ymag = 1;           ///< half width and height in scene units, orthographic
  float znear = 0;
};

struct PunctualLight {
  enum class Kind : std::uint8_t { kPoint, kSpot, kDirectional } kind = Kind::kPoint;
  Vec3 intensity{1};  ///< colour times intensity: W/sr (point, spot), W/m^2 (directional)
  Vec3 position{0};
  Vec3 direction{0, 0, -1};  ///< unit, the way the light travels (spot, directional)
  float range = 0;           ///< 0: unlimited
  float inner_cone_cos = 1, outer_cone_cos = 0.70710678f;
};

/// Names the items that a loader added to a scene because the file has none of them.
struct Added {
  bool camera = false;    ///< cameras[0] was made up
  bool inside = false;    ///< and stands inside the model
  bool sun = false;       ///< the last of the lights
  bool material = false;  ///< the last of the materials, of triangles that name none
};

struct Sky {
  Vec3 radiance{0};  ///< constant over the sphere
  SkyMap map{};      ///< added to it; empty: there is none
};

/// Everything an experiment sees; immutable once made. Materials has at least one entry.
struct Scene {
  std::string name;
  std::vector<Image> images;
  std::vector<Texture> textures;
  std::vector<Material> materials;
  std::vector<Mesh> meshes;
  std::vector<Instance> instances;         ///< all there are, also those within groups
  std::vector<Group> groups;               ///< the hierarchy beside it, which changes nothing that a ray meets
  std::vector<GroupPlacement> placements;  ///< placements of groups, parents before those inside
  std::vector<NamedNode> nodes;            ///< in depth-first order; a file may give one name to several
  Motion motion;                           ///< what may move; instances and meshes stand still
  GaussianCloud gaussians;                 ///< if any, all there is to see; instances are their shapes
  std::vector<RayProgram> programs;        ///< of primitives, whose numbers Sphere::program names
  std::vector<PunctualLight> lights;
  std::vector<Camera> cameras;  ///< at least one: the file's, or one that was made up
  Sky sky;
  Added added;

  std::size_t unique_triangle_count() const;     ///< over meshes
  std::size_t instanced_triangle_count() const;  ///< over instances
  /// World-space bounds of all instances (of transformed vertices and spheres, float arithmetic, not conservative).
  Aabb bounds() const;
  /// Those of one instance of the scene.
  Aabb bounds(const Instance& instance) const;
};

}  // namespace carousel::scene
