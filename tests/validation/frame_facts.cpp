// Prints the structure of a scene and what becomes of it at another moment, as a line of JSON, which
// tests/validation/frame_model.py computes in its own way.
//
//   frame_facts CONFIG MOMENT CLUSTER_PRIMITIVES LOCAL_PRIMITIVES      0 primitives: auto
#include <iostream>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "accel/builders/clusters.h"
#include "accel/builders/refit.h"
#include "accel/structure/cull_plane.h"
#include "app/host/log.h"
#include "app/run/prepare.h"
#include "core/config/write.h"
#include "core/system/executor.h"

namespace carousel {

namespace {

using Json = nlohmann::json;

Json box_json(const Aabb& box) {
  return {box.lo.x, box.lo.y, box.lo.z, box.hi.x, box.hi.y, box.hi.z};
}

/// A node's children by their bits with their boxes; a leaf's primitives by its first block.
Json tree_json(const accel::Accel& accel) {
  Json nodes = Json::array(), leaves = Json::object();
  for (const accel::Node& node : accel.nodes) {
    Json children = Json::array();
    for (int lane = 0; lane < node.count; ++lane) {
      const accel::NodeRef ref = node.child[lane];
      children.push_back({ref.bits(), box_json(child_box(node, lane))});
      if (ref.is_inner() || ref.is_instance()) continue;
      Json& leaf = leaves[std::to_string(ref.bits())];
      for (std::uint32_t i = 0; i < ref.triangles(); ++i)
        leaf.push_back(
            accel.blocks[ref.first_block() + i / accel::kBlockTriangles].primitive[i % accel::kBlockTriangles] &
            accel::kPrimitiveMask);
    }
    nodes.push_back({{"above_instances", node.above_instances}, {"children", children}, {"triangles", node.triangles}});
  }
  return {{"nodes", nodes}, {"leaves", leaves}, {"depth", accel.max_depth}};
}

Json corners(const scene::Mesh& mesh) {
  Json out = Json::array();
  for (const std::uint32_t index : mesh.indices) {
    const Vec3& p = mesh.positions[index];
    out.push_back({p.x, p.y, p.z});
  }
  return out;
}

Json facts_of(const std::string& file, float moment, std::uint32_t most, std::uint64_t local) {
  app::Prepared p = app::prepare_config(read_config_file(file).text, file);
  const scene::Scene after = app::load_moment(p, moment);
  const accel::SceneChange change = accel::change_of(p.scene, after);
  Json instances = Json::array(), meshes = Json::array();
  for (std::size_t i = 0; i < p.scene.instances.size(); ++i)
    instances.push_back({{"mesh", p.scene.instances[i].mesh.value},
                         {"root", p.accel.instances[i].root.bits()},
                         {"triangles", p.accel.instances[i].triangles}});
  for (std::size_t m = 0; m < p.scene.meshes.size(); ++m)
    meshes.push_back({{"before", corners(p.scene.meshes[m])}, {"after", corners(after.meshes[m])}});
  Json out = {
      {"blocks", p.accel.blocks.size()}, {"built", tree_json(p.accel)}, {"instances", instances}, {"meshes", meshes}};
  const auto executor = make_executor(1);
  accel::TreeClusters clusters =
      accel::cut_clusters(p.accel, p.scene, most > 0 ? std::optional(most) : std::nullopt, local);
  accel::Accel refitted = p.accel;
  const BvhConfig::Storage storage = p.config().bvh.storage;
  out["why"] = accel::refit(refitted, after, change, storage, *executor);
  out["refit"] = tree_json(refitted);
  std::vector<accel::ClusterWork> work;
  accel::update_clusters(p.accel, clusters, p.scene, after, change, storage, local, *executor, work);
  out["clusters"] = tree_json(p.accel);
  return out;
}

}  // namespace

}  // namespace carousel

int main(int count, char** arguments) {
  if (count != 5) return 2;
  carousel::app::start_log({}, true);  // on stderr: the facts are on stdout
  try {
    std::cout << carousel::facts_of(arguments[1], std::stof(arguments[2]),
                                    static_cast<std::uint32_t>(std::stoul(arguments[3])), std::stoull(arguments[4]))
                     .dump()
              << std::endl;
  } catch (const std::exception& error) {
    std::cerr << error.what() << std::endl;
    return 1;
  }
}
