#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/types/vec.h"
#include "scene/model/pose_choice.h"
#include "scene/model/scene.h"

namespace carousel::scene {

/// The contents of a scene file as the module "scenes" reads them. Nothing in it is checked.
struct Imported {
  static constexpr std::uint32_t kVersion = 2;

  struct Image {
    std::string name;
    std::string place;                ///< where the model names it: "arm.mtl:5"
    std::string file;                 ///< empty: the model holds it
    std::vector<std::uint8_t> bytes;  ///< encoded; or RGBA, row by row, if there is a width
    std::uint32_t width = 0, height = 0;
  };
  struct Node {
    std::string name;
    std::int64_t parent = -1;        ///< an earlier one
    std::array<double, 16> local{};  ///< column-major
    std::int64_t mesh = -1;
  };
  struct Camera {
    std::int64_t node = 0;
    std::string name;
    std::array<double, 3> position{}, direction{0, 0, -1}, up{0, 1, 0};  ///< in the node's space
    float yfov = 0;                                                      ///< radians
    float aspect = 0;                                                    ///< 0: not known
    float half_width = 0;                                                ///< orthographic, else 0
    float znear = 0;
  };
  struct Light {
    std::int64_t node = 0;
    PunctualLight::Kind kind = PunctualLight::Kind::kPoint;
    std::array<float, 3> intensity{};
    std::array<double, 3> position{}, direction{0, 0, -1};  ///< in the node's space
    float inner = 0, outer = 0;                             ///< half the angles of the cone, radians
  };

  /// What an animation does to a node; a list of times that is empty moves nothing.
  struct Channel {
    std::int64_t node = 0;
    std::vector<float> translation_times, rotation_times, scale_times;  ///< seconds, none before the one before it
    std::vector<float> translations, rotations, scales;                 ///< 3, 4 (x, y, z, w) and 3 numbers a time
  };
  /// A bone of a mesh, and the vertices that follow it.
  struct Bone {
    std::int64_t node = 0;
    std::array<double, 16> bone_from_mesh{};  ///< column-major, as the mesh was bound
    std::vector<std::uint32_t> vertices;
    std::vector<float> weights;
  };
  struct Skin {
    std::uint32_t mesh = 0;
    std::vector<Bone> bones;
  };

  std::uint32_t version = kVersion;
  std::vector<std::string> warnings;  ///< without the name of the file
  std::vector<Image> images;
  std::vector<Texture> textures;
  std::vector<Material> materials;
  std::vector<Mesh> meshes;
  std::vector<Node> nodes;  ///< parents first
  std::vector<Camera> cameras;
  std::vector<Light> lights;
  Motion motion;
  std::vector<std::vector<Channel>> animations;  ///< of a question that is posed: one a clip of `motion`
  std::vector<Skin> skins;                       ///< of a question that is posed
  std::vector<std::string> files;                ///< all that were read, and those that the model names
};

// In the order of the bytes (scene/import/wire.h). What a module does not fill in is left out.

template <class W>
void describe(W& wire, Imported::Image& v) {
  wire(v.name, v.place, v.file, v.bytes, v.width, v.height);
}
template <class W>
void describe(W& wire, Imported::Node& v) {
  wire(v.name, v.parent, v.local, v.mesh);
}
template <class W>
void describe(W& wire, Imported::Camera& v) {
  wire(v.node, v.name, v.position, v.direction, v.up, v.yfov, v.aspect, v.half_width, v.znear);
}
template <class W>
void describe(W& wire, Imported::Light& v) {
  wire(v.node);
  wire.choice(v.kind, PunctualLight::Kind::kDirectional);
  wire(v.intensity, v.position, v.direction, v.inner, v.outer);
}
template <class W>
void describe(W& wire, Texture& v) {
  wire(v.image.value);
  wire.choice(v.wrap_u, Wrap::kMirror);
  wire.choice(v.wrap_v, Wrap::kMirror);
}
template <class W>
void describe(W& wire, TextureUse& v) {
  wire(v.texture.value, v.uv_set, v.offset, v.scale, v.rotation);
}
template <class W>
void describe(W& wire, Material& v) {
  wire(v.name, v.base_color, v.base_color_texture, v.metallic, v.roughness, v.metallic_roughness_texture, v.emissive,
       v.emissive_texture, v.normal_texture, v.normal_scale);
  wire.choice(v.alpha_mode, AlphaMode::kBlend);
  wire(v.alpha_cutoff, v.double_sided, v.unlit, v.ior, v.transmission.weight);
}
template <class W>
void describe(W& wire, MaterialId& v) {
  wire(v.value);
}
template <class W>
void describe(W& wire, Mesh& v) {
  wire(v.name, v.positions, v.normals, v.uv0, v.uv1, v.colors, v.indices, v.triangle_materials);
}
template <class W>
void describe(W& wire, Motion::Clip& v) {
  wire(v.name, v.seconds, v.channels);
}
template <class W>
void describe(W& wire, Imported::Channel& v) {
  wire(v.node, v.translation_times, v.rotation_times, v.scale_times, v.translations, v.rotations, v.scales);
}
template <class W>
void describe(W& wire, Imported::Bone& v) {
  wire(v.node, v.bone_from_mesh, v.vertices, v.weights);
}
template <class W>
void describe(W& wire, Imported::Skin& v) {
  wire(v.mesh, v.bones);
}
template <class W>
void describe(W& wire, Imported& v) {
  wire(v.version, v.warnings, v.images, v.textures, v.materials, v.meshes, v.nodes, v.cameras, v.lights, v.motion.clips,
       v.motion.skins, v.motion.morph_targets, v.animations, v.skins, v.files);
}

/// What the module is asked: read this file, with so many more bytes of memory and seconds of the processor.
struct ImportQuestion {
  std::uint64_t bytes = 0;
  std::uint32_t seconds = 0;
  std::string file;
  bool posed = false;       ///< with the keys of animations and the bones of meshes
  bool files_only = false;  ///< with Imported::files alone
};
template <class W>
void describe(W& wire, ImportQuestion& v) {
  wire(v.bytes, v.seconds, v.file, v.posed, v.files_only);
}

}  // namespace carousel::scene
