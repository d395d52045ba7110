#include "scene/gltf/pose/joints.h"

#include <string>
#include <utility>

#include "scene/gltf/pose/transform.h"

namespace carousel::scene {

JointTable::JointTable(const GltfDocument& document, const tinygltf::Model& model, const AccessorTable& accessors,
                       const ImportBudget& budget)
    : document_(document), model_(model), accessors_(accessors), budget_(budget), parents_(model.nodes.size()) {
  for (std::size_t i = 0; i < model.nodes.size(); ++i)
    for (const int child : model.nodes[i].children) parents_[static_cast<std::size_t>(child)] = i;
}

const DMat4& JointTable::world_of(std::size_t node) {
  // Without recursion: a chain of nodes may be as long as the file.
  std::vector<std::size_t> chain;
  for (std::optional<std::size_t> at = node; at && !worlds_.contains(*at); at = parents_[*at]) chain.push_back(*at);
  for (std::size_t i = chain.size(); i-- > 0;) {
    const std::size_t at = chain[i];
    const DMat4 local = node_transform(document_, model_.nodes[at], json_path("/nodes", at));
    worlds_.emplace(at, parents_[at] ? worlds_.at(*parents_[at]) * local : local);
  }
  return worlds_.at(node);
}

const std::vector<DMat4>& JointTable::of(std::size_t skin) {
  const auto [entry, fresh] = skins_.try_emplace(skin);
  std::vector<DMat4>& out = entry->second;
  if (!fresh) return out;
  const Json& json = document_.json["skins"][skin];
  const Json& joints = json["joints"];
  const std::string path = json_path("/skins", skin);
  if (joints.empty()) document_.fail(json_path(path, "joints"), "expected at least one joint");
  budget_.take(joints.size() * sizeof(DMat4), path, "the skin");
  std::vector<float> inverse;
  if (json.contains("inverseBindMatrices")) {
    const std::string where = json_path(path, "inverseBindMatrices");
    const auto accessor = json["inverseBindMatrices"].get<std::size_t>();
    accessors_.check_use(accessor, AccessorUse::kInverseBind, where);
    if (accessors_.count(accessor) < joints.size())
      document_.fail(where, "accessor " + std::to_string(accessor) + " has " +
                                std::to_string(accessors_.count(accessor)) + " elements, the skin has " +
                                std::to_string(joints.size()) + " joints");
    inverse = accessors_.floats(accessor, where);
  }
  for (std::size_t j = 0; j < joints.size(); ++j) {
    DMat4 bind(1);
    for (int c = 0; c < 4 && !inverse.empty(); ++c)
      for (int r = 0; r < 3; ++r) bind[c][r] = inverse[16 * j + static_cast<std::size_t>(4 * c + r)];
    out.push_back(world_of(joints[j].get<std::size_t>()) * bind);
  }
  return out;
}

}  // namespace carousel::scene
