#include "scene/gltf/nodes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "core/numeric/trigonometry.h"
#include "core/system/plain_text.h"
#include "scene/gltf/hierarchy.h"
#include "scene/gltf/pose/animation.h"
#include "scene/gltf/pose/transform.h"
#include "scene/model/node_names.h"

namespace carousel::scene {

namespace {

Vec3 color_of(const std::vector<double>& color) {
  if (color.size() != 3) return Vec3(1);
  return Vec3(DVec3(std::max(color[0], 0.0), std::max(color[1], 0.0), std::max(color[2], 0.0)));
}

/// An instance, its place in its group, and what vectors keep free while they grow.
constexpr std::uint64_t kBytesPerInstance = 2 * (sizeof(Instance) + sizeof(Group::Member));

class NodeReader {
 public:
  NodeReader(const GltfDocument& document, const tinygltf::Model& model, const AccessorTable& accessors,
             const ImportBudget& budget, MaterialId default_material, const WarningSink& warn, Scene& scene)
      : document_(document),
        model_(model),
        accessors_(accessors),
        budget_(budget),
        default_material_(default_material),
        warn_(warn),
        scene_(scene) {}

  std::vector<NodeMesh> take_meshes() { return std::move(meshes_); }

  void walk(const std::vector<int>& roots) {
    // An explicit stack instead of recursion: a chain of nodes may be as long as the file.
    struct Visit {
      int node;
      DMat4 parent;
      std::size_t parent_entry;
      std::size_t depth;
      bool visible;  ///< as far as the ancestors say
    };
    std::vector<Visit> stack;
    for (auto root = roots.rbegin(); root != roots.rend(); ++root)
      stack.push_back({*root, DMat4(1), Hierarchy::kWorld, 0, true});
    while (!stack.empty()) {
      const Visit visit = stack.back();
      stack.pop_back();
      const tinygltf::Node& node = model_.nodes[static_cast<std::size_t>(visit.node)];
      const std::string path = json_path("/nodes", static_cast<std::size_t>(visit.node));
      const DMat4 local = node_transform(document_, node, path), world = visit.parent * local;
      const std::size_t entry = hierarchy_.add(visit.parent_entry, local, world, scene_.instances.size());
      names_.add(plain_text(node.name), visit.depth, scene_.instances.size());
      const bool visible = visit.visible && shows_itself(visit.node);
      if (visible) {
        if (document_.posing.on && node.mesh >= 0 && node.skin >= 0)
          add_skinned(node, path);
        else if (const auto mesh = mesh_of(visit.node, node, path))
          add_instances(node, *mesh, world, path);
        add_light(node, world, path);
      }
      if (node.camera >= 0) add_camera(node, world, path);
      for (auto child = node.children.rbegin(); child != node.children.rend(); ++child)
        stack.push_back({*child, world, entry, visit.depth + 1, visible});
    }
    hierarchy_.write(scene_);
    std::move(names_).write(scene_);
  }

 private:
  /// KHR_node_visibility, which hides meshes and lights, and no cameras.
  bool shows_itself(int index) const {
    const Json::json_pointer pointer("/extensions/KHR_node_visibility/visible");
    return document_.json["nodes"][static_cast<std::size_t>(index)].value(pointer, true);
  }

  /// The weights of the node's morph targets: its own, or else its mesh's; none if all are 0.
  std::vector<double> weights_of(const tinygltf::Node& node, const std::string& path) const {
    const auto index = static_cast<std::size_t>(node.mesh);
    const std::size_t targets = morph_targets(document_, model_, index);
    if (targets == 0) return {};
    const bool own = !node.weights.empty();
    const std::vector<double>& weights = own ? node.weights : model_.meshes[index].weights;
    if (std::ranges::all_of(weights, [](double w) { return w == 0; })) return {};
    if (weights.size() != targets)
      document_.fail(json_path(own ? path : json_path("/meshes", index), "weights"),
                     "expected " + std::to_string(targets) + " weights, one a morph target, found " +
                         std::to_string(weights.size()));
    return weights;
  }

  MeshId id_of(BentMesh bent) {
    const auto [entry, fresh] = bent_ids_.try_emplace(bent, next_id());
    if (fresh) meshes_.emplace_back(std::move(bent));
    return MeshId(entry->second);
  }

  std::uint32_t next_id() const { return static_cast<std::uint32_t>(model_.meshes.size() + meshes_.size()); }

  /// A mesh with a skin stands in the world, whatever the transform of its node (specification, 3.7.3.3), and so
  /// outside all groups.
  void add_skinned(const tinygltf::Node& node, const std::string& path) {
    if (node.extensions.contains("EXT_mesh_gpu_instancing") && warn_)
      warn_(document_.file + ": " + path + "/extensions/EXT_mesh_gpu_instancing: ignored, since the mesh has a skin");
    budget_.take(kBytesPerInstance, path, "the instance");
    const MeshId mesh =
        id_of({static_cast<std::size_t>(node.mesh), static_cast<std::size_t>(node.skin), weights_of(node, path)});
    hierarchy_.add(Hierarchy::kWorld, DMat4(1), DMat4(1), scene_.instances.size());
    hierarchy_.add_own(DMat4(1));
    scene_.instances.push_back({mesh, Affine{}});
  }

  std::optional<MeshId> mesh_of(int index, const tinygltf::Node& node, const std::string& path) {
    if (node.mesh >= 0) {
      std::vector<double> weights;
      if (document_.posing.on) weights = weights_of(node, path);
      if (weights.empty()) return MeshId(static_cast<std::uint32_t>(node.mesh));
      return id_of({static_cast<std::size_t>(node.mesh), std::nullopt, std::move(weights)});
    }
    const Json& json = document_.json["nodes"][static_cast<std::size_t>(index)];
    const Json::json_pointer pointer("/extras/carousel_sphere");
    if (!json.contains(pointer)) return std::nullopt;
    const Json& sphere = json.at(pointer);
    const auto radius = sphere["radius"].get<float>();
    const std::uint32_t material = sphere.value("material", default_material_.value);
    const auto [entry, fresh] = sphere_ids_.try_emplace({radius, material}, next_id());
    if (fresh) {
      Mesh mesh;
      mesh.name = node.name.empty() ? "sphere" : node.name;
      mesh.spheres.push_back({Vec3(0), radius, MaterialId(material)});
      meshes_.emplace_back(std::move(mesh));
    }
    return MeshId(entry->second);
  }

  void add_instance(MeshId mesh, const DMat4& world, const std::string& path) {
    scene_.instances.push_back({mesh, rounded(document_, world, path)});
  }

  void add_instances(const tinygltf::Node& node, MeshId mesh, const DMat4& world, const std::string& path) {
    const auto extension = node.extensions.find("EXT_mesh_gpu_instancing");
    if (extension == node.extensions.end()) {
      budget_.take(kBytesPerInstance, path, "the instance");
      hierarchy_.add_own(DMat4(1));
      add_instance(mesh, world, path);
      return;
    }
    const std::string where = path + "/extensions/EXT_mesh_gpu_instancing/attributes";
    const tinygltf::Value& attributes = extension->second.Get("attributes");
    std::optional<std::uint64_t> count;
    for (const std::string& name : attributes.Keys()) {
      const auto accessor = static_cast<std::size_t>(attributes.Get(name).GetNumberAsInt());
      if (count && *count != accessors_.count(accessor)) {
        document_.fail(json_path(where, name), "accessor " + std::to_string(accessor) + " has " +
                                                   std::to_string(accessors_.count(accessor)) +
                                                   " elements, other attributes have " + std::to_string(*count));
      }
      count = accessors_.count(accessor);
    }
    if (!count) document_.fail(where, "expected at least one attribute");
    budget_.take(*count * kBytesPerInstance, where, "the node asks for " + std::to_string(*count) + " elements, and");
    const auto read = [&](const char* name, AccessorUse use) -> std::vector<float> {
      if (!attributes.Has(name)) return {};
      const auto accessor = static_cast<std::size_t>(attributes.Get(name).GetNumberAsInt());
      accessors_.check_use(accessor, use, json_path(where, name));
      return accessors_.floats(accessor, json_path(where, name));
    };
    const std::vector<float> translations = read("TRANSLATION", AccessorUse::kTranslation);
    const std::vector<float> rotations = read("ROTATION", AccessorUse::kRotation);
    const std::vector<float> scales = read("SCALE", AccessorUse::kScale);
    const auto triple = [](const std::vector<float>& v, std::size_t i, double fallback) {
      return v.empty() ? DVec3(fallback) : DVec3(v[3 * i], v[3 * i + 1], v[3 * i + 2]);
    };
    for (std::size_t i = 0; i < *count; ++i) {
      double rotation[4] = {0, 0, 0, 1};
      for (std::size_t c = 0; c < 4 && !rotations.empty(); ++c) rotation[c] = rotations[4 * i + c];
      const auto local = compose_trs(triple(translations, i, 0), rotation, triple(scales, i, 1));
      if (!local)
        document_.fail(json_path(where, "ROTATION"),
                       "the quaternion of instance " + std::to_string(i) + " has length zero");
      hierarchy_.add_own(*local);
      add_instance(mesh, world * *local, path);
    }
  }

  Frame frame_of(const DMat4& world, const std::string& path) const {
    const auto frame = orthonormal_frame(world);
    if (!frame) document_.fail(path, "the transform to world space leaves no view direction");
    return *frame;
  }

  void add_camera(const tinygltf::Node& node, const DMat4& world, const std::string& path) {
    const tinygltf::Camera& from = model_.cameras[static_cast<std::size_t>(node.camera)];
    const Frame frame = frame_of(world, path);
    Camera to;
    to.name = from.name.empty() ? node.name : from.name;
    to.position = rounded(document_, world, path).translation;
    to.right = frame.right;
    to.up = frame.up;
    to.back = frame.back;
    if (from.type == "orthographic") {
      to.projection = Camera::Projection::kOrthographic;
      to.xmag = static_cast<float>(std::abs(from.orthographic.xmag));
      to.ymag = static_cast<float>(std::abs(from.orthographic.ymag));
      to.znear = static_cast<float>(from.orthographic.znear);
      if (!(to.xmag > 0 && to.ymag > 0)) {
        document_.fail(json_path("/cameras", static_cast<std::size_t>(node.camera)) + "/orthographic",
                       "xmag and ymag must not be 0");
      }
    } else {
      to.yfov = static_cast<float>(from.perspective.yfov);
      if (from.perspective.aspectRatio > 0) to.aspect_ratio = static_cast<float>(from.perspective.aspectRatio);
      to.znear = static_cast<float>(from.perspective.znear);
    }
    scene_.cameras.push_back(to);
  }

  void add_light(const tinygltf::Node& node, const DMat4& world, const std::string& path) {
    const auto extension = node.extensions.find("KHR_lights_punctual");
    if (extension == node.extensions.end()) return;
    const int index = extension->second.Get("light").GetNumberAsInt();
    const tinygltf::Light& from = model_.lights[static_cast<std::size_t>(index)];
    PunctualLight to;
    to.intensity = color_of(from.color) * static_cast<float>(from.intensity);
    if (!(std::isfinite(to.intensity.x) && std::isfinite(to.intensity.y) && std::isfinite(to.intensity.z))) {
      document_.fail(path, "the light is too bright for single precision");
    }
    to.position = rounded(document_, world, path).translation;
    to.range = static_cast<float>(from.range);
    if (from.type != "point") {
      const auto frame = orthonormal_frame(world);
      if (!frame) {
        if (warn_)
          warn_(document_.file + ": " + path +
                ": the light is left out, since its node's scale leaves it no direction");
        return;
      }
      to.direction = -frame->back;
    }
    if (from.type == "directional") to.kind = PunctualLight::Kind::kDirectional;
    if (from.type == "spot") {
      to.kind = PunctualLight::Kind::kSpot;
      to.inner_cone_cos = static_cast<float>(sin_cos(from.spot.innerConeAngle).cos);
      to.outer_cone_cos = static_cast<float>(sin_cos(from.spot.outerConeAngle).cos);
    }
    scene_.lights.push_back(to);
  }

  const GltfDocument& document_;
  const tinygltf::Model& model_;
  const AccessorTable& accessors_;
  const ImportBudget& budget_;
  const MaterialId default_material_;
  const WarningSink& warn_;
  Scene& scene_;
  Hierarchy hierarchy_;
  NodeNames names_;
  std::vector<NodeMesh> meshes_;
  std::map<BentMesh, std::uint32_t> bent_ids_;
  std::map<std::pair<float, std::uint32_t>, std::uint32_t> sphere_ids_;  // by radius and material
};

std::vector<int> all_roots(const tinygltf::Model& model) {
  std::vector<bool> is_child(model.nodes.size());
  for (const tinygltf::Node& node : model.nodes) {
    for (const int child : node.children) is_child[static_cast<std::size_t>(child)] = true;
  }
  std::vector<int> roots;
  for (std::size_t i = 0; i < is_child.size(); ++i) {
    if (!is_child[i]) roots.push_back(static_cast<int>(i));
  }
  return roots;
}

}  // namespace

std::vector<NodeMesh> read_nodes(const GltfDocument& document, const tinygltf::Model& model,
                                 const AccessorTable& accessors, const ImportBudget& budget,
                                 MaterialId default_material, const WarningSink& warn, Scene& scene) {
  NodeReader reader(document, model, accessors, budget, default_material, warn, scene);
  if (model.scenes.empty()) {
    reader.walk(all_roots(model));
  } else {
    const tinygltf::Scene& chosen = model.scenes[static_cast<std::size_t>(std::max(model.defaultScene, 0))];
    scene.name = chosen.name;
    reader.walk(chosen.nodes);
  }
  return reader.take_meshes();
}

}  // namespace carousel::scene
