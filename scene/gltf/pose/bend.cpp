#include "scene/gltf/pose/bend.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "scene/gltf/pose/transform.h"

namespace carousel::scene {

namespace {

class Bending {
 public:
  Bending(const GltfDocument& document, const AccessorTable& accessors, const ImportBudget& budget,
          const tinygltf::Primitive& primitive, const std::string& path)
      : document_(document), accessors_(accessors), budget_(budget), primitive_(primitive), path_(path) {}

  /// Adds the targets' differences of one attribute, "POSITION" or "NORMAL", to its values.
  void morph(const char* name, AccessorUse use, const std::vector<double>& weights, std::vector<DVec3>& values) const {
    for (std::size_t t = 0; t < std::min(weights.size(), primitive_.targets.size()); ++t) {
      const auto entry = primitive_.targets[t].find(name);
      if (weights[t] == 0 || entry == primitive_.targets[t].end()) continue;
      const std::string where = json_path(json_path(json_path(path_, "targets"), t), name);
      const std::vector<float> differences = floats(entry->second, use, values.size(), where).values;
      for (std::size_t v = 0; v < values.size(); ++v)
        values[v] += weights[t] * DVec3(differences[3 * v], differences[3 * v + 1], differences[3 * v + 2]);
    }
  }

  void skin(const Bend& bend, std::vector<DVec3>& positions, std::vector<DVec3>& normals) const {
    std::vector<Influences> sets;
    for (std::size_t n = 0;; ++n) {
      const std::string suffix = "_" + std::to_string(n);
      const auto entry = primitive_.attributes.find("JOINTS" + suffix);
      if (entry == primitive_.attributes.end() && n > 0) break;
      sets.push_back(influences(suffix, positions.size()));
    }
    for (std::size_t v = 0; v < positions.size(); ++v) {
      DMat4 sum(0);
      double whole = 0;
      for (std::size_t n = 0; n < sets.size(); ++n) {
        for (std::size_t i = 4 * v; i < 4 * v + 4; ++i) {
          const double weight = sets[n].weights.values[i];
          if (weight == 0) continue;
          sum += weight * joint(bend, sets[n].joints[i], v, n);
          whole += weight;
        }
      }
      const DMat4 m = whole != 0 ? sum / whole : joint(bend, sets[0].joints[4 * v], v, 0);
      positions[v] = DVec3(m * glm::dvec4(positions[v], 1));
      if (!normals.empty()) normals[v] = moved_normal(m, normals[v]);
    }
  }

  std::vector<Vec3> rounded(const std::vector<DVec3>& values) const {
    std::vector<Vec3> out(values.begin(), values.end());
    for (std::size_t v = 0; v < out.size(); ++v)
      if (!(std::isfinite(out[v].x) && std::isfinite(out[v].y) && std::isfinite(out[v].z)))
        document_.fail(json_path(path_, "attributes"),
                       "the pose moves vertex " + std::to_string(v) + " farther than single precision reaches");
    return out;
  }

 private:
  struct Floats {
    std::vector<float> values;
    MemoryBudget::Loan loan;
  };
  struct Influences {
    std::vector<std::uint32_t> joints;  ///< four a vertex, as the weights are
    Floats weights;
  };

  void check(int accessor, AccessorUse use, std::size_t vertices, const std::string& path) const {
    const auto index = static_cast<std::size_t>(accessor);
    accessors_.check_use(index, use, path);
    if (accessors_.count(index) != vertices)
      document_.fail(path, "accessor " + std::to_string(accessor) + " has " + std::to_string(accessors_.count(index)) +
                               " elements, POSITION has " + std::to_string(vertices));
  }

  Floats floats(int accessor, AccessorUse use, std::size_t vertices, const std::string& path) const {
    check(accessor, use, vertices, path);
    const auto index = static_cast<std::size_t>(accessor);
    auto loan = budget_.lend(vertices * static_cast<std::size_t>(accessors_.components(index)) * sizeof(float), path,
                             "the attribute");
    return {accessors_.floats(index, path), std::move(loan)};
  }

  Influences influences(const std::string& suffix, std::size_t vertices) const {
    const std::string attributes = json_path(path_, "attributes");
    for (const char* name : {"JOINTS", "WEIGHTS"})
      if (!primitive_.attributes.contains(name + suffix))
        document_.fail(json_path(attributes, name + suffix), "missing, though the node of the mesh has a skin");
    const int joints = primitive_.attributes.at("JOINTS" + suffix);
    const std::string where = json_path(attributes, "JOINTS" + suffix);
    check(joints, AccessorUse::kJoints, vertices, where);
    Influences out;
    out.weights = floats(primitive_.attributes.at("WEIGHTS" + suffix), AccessorUse::kSkinWeights, vertices,
                         json_path(attributes, "WEIGHTS" + suffix));
    out.weights.loan = budget_.lend(vertices * 4 * (sizeof(float) + sizeof(std::uint32_t)), where, "the attribute");
    out.joints = accessors_.integers(static_cast<std::size_t>(joints), where);
    return out;
  }

  const DMat4& joint(const Bend& bend, std::uint32_t index, std::size_t vertex, std::size_t set) const {
    if (index >= bend.joints->size())
      document_.fail(json_path(json_path(path_, "attributes"), "JOINTS_" + std::to_string(set)),
                     "joint " + std::to_string(index) + " of vertex " + std::to_string(vertex) + " is beyond the " +
                         std::to_string(bend.joints->size()) + " joints of skin " + std::to_string(bend.skin));
    return (*bend.joints)[index];
  }

  const GltfDocument& document_;
  const AccessorTable& accessors_;
  const ImportBudget& budget_;
  const tinygltf::Primitive& primitive_;
  const std::string& path_;
};

}  // namespace

void bend_vertices(const GltfDocument& document, const AccessorTable& accessors, const ImportBudget& budget,
                   const tinygltf::Primitive& primitive, const std::string& path, const Bend& bend,
                   std::vector<Vec3>& positions, std::vector<Vec3>& normals) {
  const Bending bending(document, accessors, budget, primitive, path);
  const auto loan = budget.lend((positions.size() + normals.size()) * (sizeof(DVec3) + sizeof(Vec3)), path,
                                "the pose of the primitive");
  std::vector<DVec3> p(positions.begin(), positions.end()), n(normals.begin(), normals.end());
  bending.morph("POSITION", AccessorUse::kMorphPosition, bend.weights, p);
  if (!n.empty()) bending.morph("NORMAL", AccessorUse::kMorphNormal, bend.weights, n);
  if (bend.joints != nullptr) bending.skin(bend, p, n);
  positions = bending.rounded(p);
  if (!n.empty()) normals = bending.rounded(n);
}

}  // namespace carousel::scene
