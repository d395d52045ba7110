#include "scene/gltf/import.h"

#include <algorithm>
#include <fstream>
#include <map>
#include <new>
#include <optional>
#include <stdexcept>
#include <utility>
#include <variant>
#include <vector>

#include "core/system/error.h"
#include "core/system/memory_budget.h"
#include "core/system/plain_text.h"
#include "scene/gltf/bounded_import.h"
#include "scene/gltf/buffers/accessor.h"
#include "scene/gltf/buffers/buffers.h"
#include "scene/gltf/buffers/draco.h"
#include "scene/gltf/buffers/meshopt.h"
#include "scene/gltf/buffers/model.h"
#include "scene/gltf/document/checks.h"
#include "scene/gltf/document/document.h"
#include "scene/gltf/document/schema.h"
#include "scene/gltf/gaussians.h"
#include "scene/gltf/materials/images.h"
#include "scene/gltf/materials/materials.h"
#include "scene/gltf/meshes.h"
#include "scene/gltf/nodes.h"
#include "scene/gltf/pose/animation.h"
#include "scene/gltf/pose/joints.h"
#include "scene/model/fitted_camera.h"

namespace carousel::scene {

namespace {

/// Reads the meshes that instances name (by the file's indices, then those of `made`) and renumbers them for the
/// scene, in the file's order.
void read_used_meshes(MeshReader& reader, DracoReader& draco, JointTable& joints, tinygltf::Model& model,
                      std::vector<NodeMesh> made, Scene& scene) {
  const std::size_t file_meshes = model.meshes.size();
  std::vector<std::optional<MeshId>> ids(file_meshes + made.size());
  for (const Instance& instance : scene.instances) ids[instance.mesh.value] = MeshId(0);
  for (std::size_t i = 0; i < ids.size(); ++i) {
    if (!ids[i]) continue;
    ids[i] = MeshId(static_cast<std::uint32_t>(scene.meshes.size()));
    if (i < file_meshes) {
      draco.decode(i, model.meshes[i]);
      scene.meshes.push_back(reader.read(i));
    } else if (const auto* bent = std::get_if<BentMesh>(&made[i - file_meshes])) {
      draco.decode(bent->mesh, model.meshes[bent->mesh]);
      Bend bend{.weights = bent->weights};
      if (bent->skin) {
        bend.joints = &joints.of(*bent->skin);
        bend.skin = *bent->skin;
      }
      scene.meshes.push_back(reader.read(bent->mesh, &bend));
    } else {
      scene.meshes.push_back(std::move(std::get<Mesh>(made[i - file_meshes])));
    }
  }
  for (Instance& instance : scene.instances) instance.mesh = *ids[instance.mesh.value];
  for (Group& group : scene.groups)
    for (Group::Member& member : group.members)
      if (!member.is_group) member.index = ids[member.index]->value;
}

Scene import(std::span<const std::byte> bytes, const std::string& file, std::optional<std::filesystem::path> folder,
             const WarningSink& warn, const ImageChoice& choice, const std::optional<PoseChoice>& pose,
             Executor* executor, MemoryBudget& memory) {
  GltfDocument document = parse_document(bytes, file);
  document.morph_targets = count_morph_targets(document.json);
  if (pose) document.posing = {true, chosen_animations(document.json, *pose, file)};
  check_extensions(document, warn);
  check_schema(document, warn);
  check_links(document, warn);
  Scene scene;
  const std::vector<std::size_t> images = read_materials(document, scene, warn);
  scene.added.material = true;
  const MaterialId default_material(static_cast<std::uint32_t>(scene.materials.size() - 1));
  const ImportBudget budget(document, memory);
  const GltfResources resources(document, budget, std::move(folder));
  GltfModel model = read_model(document, resources);

  const std::map<std::size_t, Bytes> unpacked = decode_meshopt_views(document, model, budget);
  AccessorTable accessors(document, model, unpacked, budget, warn);
  scene.motion = motion_of(document, accessors);
  if (pose) pose_nodes(document, accessors, budget, *pose, warn, model.model);
  std::vector<NodeMesh> made = read_nodes(document, model.model, accessors, budget, default_material, warn, scene);
  read_gaussians(document, model.model, accessors, budget, scene);
  MeshReader meshes(document, model.model, accessors, budget, default_material, warn);
  DracoReader draco(document, accessors, budget);
  JointTable joints(document, model.model, accessors, budget);
  read_used_meshes(meshes, draco, joints, model.model, std::move(made), scene);
  if (meshes.skipped_primitives() > 0 && warn) {
    warn(file + ": " + std::to_string(meshes.skipped_primitives()) +
         " primitives skipped: points, lines or without positions");
  }
  const bool empty = scene.gaussians.empty() && std::ranges::all_of(scene.meshes, [](const Mesh& m) {
                       return m.indices.empty() && m.spheres.empty();
                     });
  read_images(document, resources, model, budget, images, choice, executor, scene);
  if (empty) {
    // Other faults come first: they may be why nothing is shown.
    for (std::size_t i = 0; i < model.model.meshes.size(); ++i) {
      draco.decode(i, model.model.meshes[i]);
      meshes.read(i);
    }
    document.fail("", scene.instances.empty() ? "the scene shows no triangles: no node of it has a mesh"
                                              : "the scene shows no triangles");
  }
  if (scene.cameras.empty()) {
    scene.cameras.push_back(fitted_camera(scene));
    scene.added.camera = true;
  }
  if (scene.name.empty()) scene.name = std::filesystem::path(file).stem().string();
  scene.name = plain_text(scene.name);
  return scene;
}

}  // namespace

Scene load_gltf(const std::filesystem::path& file, const WarningSink& warn, const ImageChoice& images,
                const std::optional<PoseChoice>& pose, Executor* executor) {
  const std::string name = file.string();
  std::error_code error;
  if (!std::filesystem::is_regular_file(file, error)) throw SceneError(name, "", "no such file");
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  std::ifstream stream(file, std::ios::binary);
  if (error || !stream) throw SceneError(name, "", "cannot be read");
  try {
    MemoryBudget memory(MemoryBudget::of_process());
    memory.take(size);
    std::vector<std::byte> bytes(static_cast<std::size_t>(size));
    stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    if (static_cast<std::uintmax_t>(stream.gcount()) != size) throw SceneError(name, "", "reading failed");
    return import(bytes, name, file.parent_path(), warn, images, pose, executor, memory);
  } catch (const std::bad_alloc&) {
    throw SceneError(name, "", "not enough memory to load it");
  } catch (const std::length_error& too_much) {
    throw SceneError(name, "", std::string("the file ") + too_much.what());
  }
}

Scene load_gltf_within(std::uint64_t budget_bytes, std::span<const std::byte> bytes, const std::string& name,
                       const WarningSink& warn, const ImageChoice& images, const std::optional<PoseChoice>& pose) {
  try {
    MemoryBudget memory(budget_bytes);
    return import(bytes, name, std::nullopt, warn, images, pose, nullptr, memory);
  } catch (const std::bad_alloc&) {
    throw SceneError(name, "", "not enough memory to load it");
  }
}

Scene load_gltf_from_memory(std::span<const std::byte> bytes, const std::string& name, const WarningSink& warn,
                            const ImageChoice& images, const std::optional<PoseChoice>& pose) {
  return load_gltf_within(MemoryBudget::of_process(), bytes, name, warn, images, pose);
}

}  // namespace carousel::scene
