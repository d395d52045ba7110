#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include <glm/geometric.hpp>

#include "core/numeric/trigonometry.h"
#include "core/system/error.h"
#include "core/system/plain_text.h"
#include "scene/gltf/hierarchy.h"
#include "scene/gltf/pose/transform.h"
#include "scene/import/import_file.h"
#include "scene/import/imported_pose.h"
#include "scene/model/fitted_camera.h"
#include "scene/model/node_names.h"

namespace carousel::scene {

namespace {

template <class V>
bool is_finite(const V& v) {
  for (int i = 0; i < V::length(); ++i)
    if (!std::isfinite(v[i])) return false;
  return true;
}

DVec3 vector_of(const std::array<double, 3>& v) {
  return {v[0], v[1], v[2]};
}

/// Makes a scene of what the module says, and trusts none of it.
class SceneMaker {
 public:
  SceneMaker(Imported& from, std::string file, MemoryBudget& memory)
      : from_(from), file_(std::move(file)), memory_(memory) {}

  Scene make() {
    scene_.name = plain_text(std::filesystem::path(file_).stem().string());
    for (const Imported::Image& image : from_.images) scene_.images.emplace_back().name = image.name;
    scene_.textures = std::move(from_.textures);
    for (const Texture& texture : scene_.textures)
      expect(texture.image.value < scene_.images.size(), "a texture names no image");
    scene_.materials = std::move(from_.materials);
    for (Material& material : scene_.materials) check(material);
    scene_.materials.emplace_back().double_sided = true;  // of triangles that name none
    scene_.added.material = true;
    scene_.meshes = std::move(from_.meshes);
    for (std::size_t m = 0; m < scene_.meshes.size(); ++m) check(scene_.meshes[m], m);
    find_skins();
    place();
    bend();
    for (const Imported::Camera& camera : from_.cameras) add(camera);
    for (const Imported::Light& light : from_.lights) add(light);
    scene_.motion = std::move(from_.motion);
    for (Motion::Clip& clip : scene_.motion.clips) clip.name = plain_text(clip.name);
    if (scene_.instanced_triangle_count() == 0) fail("the scene shows no triangles");
    if (scene_.cameras.empty()) {
      scene_.cameras.push_back(fitted_camera(scene_));
      scene_.added.camera = true;
    }
    return std::move(scene_);
  }

 private:
  [[noreturn]] void fail(const std::string& message) const { throw SceneError(file_, "", message); }
  void expect(bool holds, const char* fault) const {
    if (!holds) fail(std::string("the module's answer is broken: ") + fault);
  }

  static float unit(float value, float fallback) {
    return std::isfinite(value) ? std::clamp(value, 0.0f, 1.0f) : fallback;
  }

  void check(Material& m) const {
    m.name = plain_text(m.name);
    for (int c = 0; c < 4; ++c) m.base_color[c] = unit(m.base_color[c], 1);
    m.metallic = unit(m.metallic, 0);
    m.roughness = unit(m.roughness, 1);
    m.transmission.weight = unit(m.transmission.weight, 0);
    m.alpha_cutoff = unit(m.alpha_cutoff, 0.5f);
    for (int c = 0; c < 3; ++c) m.emissive[c] = std::isfinite(m.emissive[c]) ? std::max(m.emissive[c], 0.0f) : 0;
    if (!std::isfinite(m.normal_scale)) m.normal_scale = 1;
    if (!(std::isfinite(m.ior) && m.ior >= 1)) m.ior = 1.5f;
    for (const auto* use :
         {&m.base_color_texture, &m.metallic_roughness_texture, &m.emissive_texture, &m.normal_texture}) {
      if (!*use) continue;
      expect((*use)->texture.value < scene_.textures.size(), "a material names no texture");
      expect((*use)->uv_set <= 1, "a texture has no such coordinates");
      expect(is_finite((*use)->offset) && is_finite((*use)->scale) && std::isfinite((*use)->rotation),
             "a texture's transform is not finite");
    }
  }

  void check(Mesh& mesh, std::size_t index) const {
    const std::size_t vertices = mesh.positions.size();
    mesh.name = plain_text(mesh.name);
    const auto fits = [&](const auto& values) { return values.empty() || values.size() == vertices; };
    expect(vertices <= 0xffffffffu && fits(mesh.normals) && fits(mesh.uv0) && fits(mesh.uv1) && fits(mesh.colors),
           "a mesh has not one value a vertex");
    expect(mesh.indices.size() % 3 == 0 && mesh.triangle_materials.size() == mesh.triangle_count(),
           "a mesh has not three indices and a material a triangle");
    for (const std::uint32_t i : mesh.indices) expect(i < vertices, "an index is beyond its vertices");
    const auto last = static_cast<std::uint32_t>(scene_.materials.size() - 1);
    for (MaterialId& id : mesh.triangle_materials) id.value = std::min(id.value, last);
    for (std::size_t v = 0; v < vertices; ++v) {
      const auto at = [&] {
        return "mesh " + std::to_string(index) + " \"" + mesh.name + "\", vertex " + std::to_string(v);
      };
      if (!is_finite(mesh.positions[v])) fail(at() + ": the position is not finite");
      if (!mesh.uv0.empty() && !is_finite(mesh.uv0[v])) mesh.uv0[v] = Vec2(0);
      if (!mesh.uv1.empty() && !is_finite(mesh.uv1[v])) mesh.uv1[v] = Vec2(0);
      if (!mesh.colors.empty() && !is_finite(mesh.colors[v])) mesh.colors[v] = Vec4(1);
      if (mesh.normals.empty()) continue;
      const DVec3 n(mesh.normals[v]);
      const double length = glm::length(n);
      mesh.normals[v] = length > 0 && std::isfinite(length) ? Vec3(n / length) : Vec3(0, 0, 1);
    }
  }

  void find_skins() {
    skinned_.assign(scene_.meshes.size(), false);
    for (const Imported::Skin& skin : from_.skins) {
      expect(skin.mesh < scene_.meshes.size(), "a skin has no mesh");
      expect(!skinned_[skin.mesh], "a mesh has two skins");
      skinned_[skin.mesh] = true;
    }
  }

  /// Puts meshes with bones into the world.
  void bend() {
    for (const Imported::Skin& skin : from_.skins) {
      const auto shows = [&](const Imported::Node& node) { return node.mesh == static_cast<std::int64_t>(skin.mesh); };
      const auto own = std::ranges::find_if(from_.nodes, shows);
      if (own == from_.nodes.end()) continue;
      bend_mesh(skin, worlds_, static_cast<std::size_t>(own - from_.nodes.begin()), memory_, scene_.meshes[skin.mesh]);
    }
  }

  /// Composes the nodes' transforms, adds instances, and finds groups.
  void place() {
    Hierarchy hierarchy;
    NodeNames names;
    std::vector<std::size_t> depths;
    for (std::size_t i = 0; i < from_.nodes.size(); ++i) {
      const Imported::Node& node = from_.nodes[i];
      expect(node.parent < static_cast<std::int64_t>(i) && node.mesh < static_cast<std::int64_t>(scene_.meshes.size()),
             "the nodes form no tree");
      const bool root = node.parent < 0;
      const auto parent = root ? Hierarchy::kWorld : static_cast<std::size_t>(node.parent);
      DMat4 local;
      for (int c = 0; c < 4; ++c)
        for (int r = 0; r < 4; ++r) local[c][r] = r < 3 ? node.local[static_cast<std::size_t>(4 * c + r)] : c == 3;
      worlds_.push_back(root ? local : worlds_[parent] * local);
      depths.push_back(root ? 0 : depths[parent] + 1);
      hierarchy.add(parent, local, worlds_.back(), scene_.instances.size());
      names.add(plain_text(node.name), depths.back(), scene_.instances.size());
      if (node.mesh < 0) continue;
      if (skinned_[static_cast<std::size_t>(node.mesh)]) {  // stands in the world, outside all groups
        hierarchy.add(Hierarchy::kWorld, DMat4(1), DMat4(1), scene_.instances.size());
        hierarchy.add_own(DMat4(1));
        scene_.instances.push_back({MeshId(static_cast<std::uint32_t>(node.mesh)), Affine{}});
        continue;
      }
      hierarchy.add_own(DMat4(1));
      scene_.instances.push_back({MeshId(static_cast<std::uint32_t>(node.mesh)), rounded(i)});
    }
    hierarchy.write(scene_);
    std::move(names).write(scene_);
  }

  Affine rounded(std::size_t node) const {
    Affine out;
    for (int c = 0; c < 3; ++c) out.linear[c] = Vec3(DVec3(worlds_[node][c]));
    out.translation = Vec3(DVec3(worlds_[node][3]));
    if (!(is_finite(out.linear[0]) && is_finite(out.linear[1]) && is_finite(out.linear[2]) &&
          is_finite(out.translation)))
      fail("node " + std::to_string(node) + " \"" + plain_text(from_.nodes[node].name) +
           "\": the transform to world space is too large for single precision");
    return out;
  }

  const DMat4& world_of(std::int64_t node) const {
    expect(node >= 0 && node < static_cast<std::int64_t>(worlds_.size()), "a camera or a light has no node");
    return worlds_[static_cast<std::size_t>(node)];
  }

  /// Where something stands in the world, and its axes. Empty where it has no direction.
  std::optional<std::pair<Vec3, Frame>> pose(std::int64_t node, const std::array<double, 3>& position,
                                             const std::array<double, 3>& direction, const DVec3& up) const {
    const DMat4& world = world_of(node);
    const Vec3 at(DVec3(world * glm::dvec4(vector_of(position), 1)));
    DMat4 axes(1);
    axes[1] = world * glm::dvec4(up, 0);
    axes[2] = -(world * glm::dvec4(vector_of(direction), 0));
    const auto frame = orthonormal_frame(axes);
    if (!frame || !is_finite(at) || !is_finite(frame->right) || !is_finite(frame->up)) return std::nullopt;
    return std::pair(at, *frame);
  }

  void add(const Imported::Camera& from) {
    const auto placed = pose(from.node, from.position, from.direction, vector_of(from.up));
    if (!placed) return;
    Camera to;
    to.name = plain_text(from.name);
    to.position = placed->first;
    to.right = placed->second.right;
    to.up = placed->second.up;
    to.back = placed->second.back;
    to.znear = std::isfinite(from.znear) ? std::max(from.znear, 0.0f) : 0;
    if (from.half_width > 0 && std::isfinite(from.half_width)) {
      to.projection = Camera::Projection::kOrthographic;
      to.xmag = from.half_width;
      to.ymag = from.aspect > 0 && std::isfinite(from.half_width / from.aspect) ? from.half_width / from.aspect
                                                                                : from.half_width;
    } else {
      if (from.yfov > 0 && from.yfov < 3.14f) to.yfov = from.yfov;
      if (from.aspect > 0) to.aspect_ratio = from.aspect;
    }
    scene_.cameras.push_back(to);
  }

  void add(const Imported::Light& from) {
    const auto placed = pose(from.node, from.position, from.direction, DVec3(0, 1, 0));
    PunctualLight to;
    to.kind = from.kind;
    to.intensity = Vec3(from.intensity[0], from.intensity[1], from.intensity[2]);
    if (!placed || !is_finite(to.intensity)) return;
    to.intensity = glm::max(to.intensity, Vec3(0));
    to.position = placed->first;
    to.direction = -placed->second.back;
    if (to.kind == PunctualLight::Kind::kSpot) {
      constexpr float kWidest = 1.5707964f;
      const float outer = std::isfinite(from.outer) ? std::clamp(from.outer, 1e-3f, kWidest) : kWidest;
      const float inner = std::isfinite(from.inner) ? std::clamp(from.inner, 0.0f, 0.999f * outer) : 0;
      to.outer_cone_cos = cos_float(outer);
      to.inner_cone_cos = cos_float(inner);
    }
    scene_.lights.push_back(to);
  }

  Imported& from_;
  std::string file_;
  MemoryBudget& memory_;
  Scene scene_;
  std::vector<DMat4> worlds_;  ///< by node
  std::vector<bool> skinned_;  ///< by mesh
};

}  // namespace

Scene scene_of(Imported imported, const std::filesystem::path& file, const WarningSink& warn, MemoryBudget& memory,
               const std::optional<PoseChoice>& pose) {
  const std::string name = file.string();
  const auto say = [&](const std::string& warning) {
    if (warn) warn(name + ": " + warning);
  };
  for (const std::string& warning : imported.warnings) say(plain_text(warning));
  if (pose) pose_nodes(imported, *pose, name, warn);
  Scene scene = SceneMaker(imported, name, memory).make();
  if (scene.motion.any() && !pose)
    say("ignored, the base pose is shown: animations, skins and morph targets (scene.time shows a moment)");
  if (pose && scene.motion.morph_targets > 0)
    say("morph targets are read from glTF alone, and are ignored; meshes keep their base shape");
  return scene;
}

}  // namespace carousel::scene
