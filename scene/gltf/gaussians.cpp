#include "scene/gltf/gaussians.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <glm/matrix.hpp>

namespace carousel::scene {

namespace {

constexpr const char* kExtension = "KHR_gaussian_splatting";

std::string attribute(const char* name) {
  return std::string(kExtension) + ":" + name;
}

class GaussianReader {
 public:
  GaussianReader(const GltfDocument& document, const tinygltf::Model& model, const AccessorTable& accessors,
                 const ImportBudget& budget, Scene& scene)
      : document_(document), model_(model), accessors_(accessors), budget_(budget), cloud_(scene.gaussians) {}

  /// All primitives get room for harmonics of the highest degree, so this goes first.
  void find_degree(std::size_t mesh) {
    for_each_primitive(mesh, [&](const tinygltf::Primitive& primitive, const std::string& path) {
      cloud_.degree = std::max(cloud_.degree, degree_of(primitive, path));
    });
  }
  void add(std::size_t mesh, const Affine& world_from_model) {
    for_each_primitive(mesh, [&](const tinygltf::Primitive& primitive, const std::string& path) {
      add_primitive(primitive, path, world_from_model);
    });
  }

 private:
  template <class Take>
  void for_each_primitive(std::size_t mesh, const Take& take) {
    const std::vector<tinygltf::Primitive>& primitives = model_.meshes[mesh].primitives;
    for (std::size_t p = 0; p < primitives.size(); ++p)
      if (has_gaussians(primitives[p]))
        take(primitives[p], json_path(json_path(json_path("/meshes", mesh), "primitives"), p));
  }

  static std::string harmonic(int degree, int order) {
    return attribute(fmt::format("SH_DEGREE_{}_COEF_{}", degree, order).c_str());
  }
  /// The degree of a primitive's harmonics: all coefficients up to it are there, and none above.
  int degree_of(const tinygltf::Primitive& primitive, const std::string& path) const {
    int degree = 0;
    const std::string prefix = attribute("SH_DEGREE_");
    for (const auto& [name, accessor] : primitive.attributes) {
      if (!name.starts_with(prefix)) continue;
      int of = 0;
      while (of <= kMostHarmonicDegree && !is_of_degree(name, of)) ++of;
      if (of > kMostHarmonicDegree)
        document_.fail(json_path(json_path(path, "attributes"), name),
                       "expected harmonics of degree 0 to 3, each with coefficients 0 to twice its degree");
      degree = std::max(degree, of);
    }
    for (int of = 1; of <= degree; ++of)
      for (int k = 0; k <= 2 * of; ++k)
        if (!primitive.attributes.contains(harmonic(of, k)))
          document_.fail(
              json_path(path, "attributes"),
              fmt::format("expected the attribute {}, as there are harmonics of degree {}", harmonic(of, k), degree));
    return degree;
  }
  static bool is_of_degree(const std::string& name, int degree) {
    for (int k = 0; k <= 2 * degree; ++k)
      if (name == harmonic(degree, k)) return true;
    return false;
  }

  /// The number of the frame of a node in which harmonics are given: a direction in the world goes the way back.
  std::uint32_t frame_of(const Affine& world) {
    const Mat3& m = world.linear;
    if (cloud_.degree == 0 || (m[0][0] > 0 && m == Mat3(m[0][0]))) return 0;
    if (cloud_.frames.empty()) cloud_.frames.emplace_back(1.0);
    cloud_.frames.push_back(glm::inverse(DMat3(m)));
    return static_cast<std::uint32_t>(cloud_.frames.size() - 1);
  }

  void add_primitive(const tinygltf::Primitive& primitive, const std::string& path, const Affine& world) {
    if (primitive.mode != TINYGLTF_MODE_POINTS)
      document_.fail(json_path(path, "mode"), std::string("a primitive with ") + kExtension +
                                                  " consists of points; expected 0, found " +
                                                  std::to_string(primitive.mode));
    if (primitive.indices >= 0)
      document_.fail(json_path(path, "indices"), "Gaussians are not indexed; expected no indices");
    take_color_space(path);
    const auto position = primitive.attributes.find("POSITION");
    if (position == primitive.attributes.end())
      document_.fail(json_path(path, "attributes"), "expected the attribute POSITION");
    count_ = accessors_.count(static_cast<std::size_t>(position->second));
    budget_.take(count_ * (sizeof(Gaussian) + higher_harmonics(cloud_.degree) * sizeof(Vec3)), path,
                 std::to_string(count_) + " Gaussians: the primitive");
    const auto floats = [&](const std::string& name, AccessorUse use) { return read(primitive, path, name, use); };
    const std::vector<float> means = floats("POSITION", AccessorUse::kPosition);
    const std::vector<float> rotations = floats(attribute("ROTATION"), AccessorUse::kRotation);
    const std::vector<float> scales = floats(attribute("SCALE"), AccessorUse::kScale);
    const std::vector<float> opacities = floats(attribute("OPACITY"), AccessorUse::kOpacity);
    const std::vector<float> colors = floats(attribute("SH_DEGREE_0_COEF_0"), AccessorUse::kScale);
    std::vector<std::vector<float>> higher;
    for (int degree = 1; degree <= degree_of(primitive, path); ++degree)
      for (int k = 0; k <= 2 * degree; ++k) higher.push_back(floats(harmonic(degree, k), AccessorUse::kScale));
    if (const float volume = glm::determinant(world.linear); volume == 0 || !std::isfinite(volume))
      document_.fail(path, "a node's transform flattens the Gaussians; expected one with an inverse");
    const std::uint32_t frame = frame_of(world);
    const std::string where = json_path(path, "attributes");
    const auto triple = [](const std::vector<float>& v, std::size_t i) {
      return Vec3(v[3 * i], v[3 * i + 1], v[3 * i + 2]);
    };
    for (std::size_t i = 0; i < count_; ++i) {
      const Vec3 deviations = triple(scales, i);
      if (std::min({deviations.x, deviations.y, deviations.z}) < 0)
        document_.fail(
            json_path(where, attribute("SCALE")),
            fmt::format("Gaussian {} has the scale {}, {}, {}; expected lengths from 0 on (early drafts of the "
                        "extension had logarithms)",
                        i, deviations.x, deviations.y, deviations.z));
      if (!(opacities[i] >= 0 && opacities[i] <= 1))
        document_.fail(json_path(where, attribute("OPACITY")),
                       fmt::format("Gaussian {} has the opacity {}; expected 0 to 1", i, opacities[i]));
      const double rotation[4] = {rotations[4 * i], rotations[4 * i + 1], rotations[4 * i + 2], rotations[4 * i + 3]};
      const std::optional<Mat3> spread = spread_of(rotation, DVec3(deviations));
      if (!spread)
        document_.fail(where, fmt::format("Gaussian {} has no shape: its rotation or all its scales are 0", i));
      cloud_.shapes.push_back({world.linear * triple(means, i) + world.translation, world.linear * *spread,
                               opacities[i], color_of_harmonics(triple(colors, i)), frame});
      for (std::size_t k = 0; k < higher_harmonics(cloud_.degree); ++k)
        cloud_.harmonics.push_back(k < higher.size() ? triple(higher[k], i) : Vec3(0));
    }
  }

  void take_color_space(const std::string& path) {
    const std::string where = path + "/extensions/" + kExtension;
    const bool display =
        document_.json.at(Json::json_pointer(where + "/colorSpace")).get<std::string>() == "srgb_rec709_display";
    if (!cloud_.empty() && display != cloud_.display)
      document_.fail(where + "/colorSpace", "the Gaussians of a file are blended in one colour space, found two");
    cloud_.display = display;
  }

  std::vector<float> read(const tinygltf::Primitive& primitive, const std::string& path, const std::string& name,
                          AccessorUse use) const {
    const std::string attributes = json_path(path, "attributes");
    const auto entry = primitive.attributes.find(name);
    if (entry == primitive.attributes.end()) document_.fail(attributes, "expected the attribute " + name);
    const auto accessor = static_cast<std::size_t>(entry->second);
    const std::string where = json_path(attributes, name);
    accessors_.check_use(accessor, use, where);
    if (accessors_.count(accessor) != count_)
      document_.fail(where, fmt::format("accessor {} has {} elements, POSITION has {}", accessor,
                                        accessors_.count(accessor), count_));
    return accessors_.floats(accessor, where);
  }

  const GltfDocument& document_;
  const tinygltf::Model& model_;
  const AccessorTable& accessors_;
  const ImportBudget& budget_;
  GaussianCloud& cloud_;
  std::uint64_t count_ = 0;  // Gaussians of the primitive
};

}  // namespace

bool has_gaussians(const tinygltf::Primitive& primitive) {
  return primitive.extensions.contains(kExtension);
}

void read_gaussians(const GltfDocument& document, const tinygltf::Model& model, const AccessorTable& accessors,
                    const ImportBudget& budget, Scene& scene) {
  GaussianReader reader(document, model, accessors, budget, scene);
  const auto of_file = [&](const Instance& instance) { return instance.mesh.value < model.meshes.size(); };
  for (const Instance& instance : scene.instances)
    if (of_file(instance)) reader.find_degree(instance.mesh.value);
  for (const Instance& instance : scene.instances)
    if (of_file(instance)) reader.add(instance.mesh.value, instance.world_from_model);
}

}  // namespace carousel::scene
