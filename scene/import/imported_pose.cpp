#include "scene/import/imported_pose.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <optional>
#include <stdexcept>

#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>

#include "core/system/plain_text.h"
#include "scene/gltf/pose/animation.h"
#include "scene/gltf/pose/track.h"
#include "scene/gltf/pose/transform.h"

namespace carousel::scene {

namespace {

void expect(bool holds, const char* fault) {
  if (!holds) throw std::runtime_error(std::string("the module's answer is broken: ") + fault);
}

DMat4 matrix_of(const std::array<double, 16>& columns) {
  DMat4 out;
  for (int c = 0; c < 4; ++c)
    for (int r = 0; r < 4; ++r) out[c][r] = r < 3 ? columns[static_cast<std::size_t>(4 * c + r)] : c == 3;
  return out;
}

/// The value of keys at a time; none where there are no keys.
std::optional<std::vector<double>> value_at(std::vector<float>& times, std::vector<float>& values, std::size_t width,
                                            double seconds) {
  expect(values.size() == times.size() * width, "an animation has not one value a time");
  if (times.empty()) return std::nullopt;
  const auto finite = [](float v) { return std::isfinite(v); };
  expect(std::ranges::all_of(times, finite) && std::ranges::is_sorted(times) && std::ranges::all_of(values, finite),
         "keys of an animation are not in order");
  Track track;
  track.width = width;
  track.rotation = width == 4;
  for (std::size_t i = 0; track.rotation && i < values.size(); i += 4)
    expect(values[i] != 0 || values[i + 1] != 0 || values[i + 2] != 0 || values[i + 3] != 0, "a rotation is zero");
  track.times = std::move(times);
  track.values = std::move(values);
  return track.at(seconds);
}

/// A matrix as translation, rotation and scale; shear is lost.
struct Parts {
  DVec3 translation, scale;
  double rotation[4];
};

Parts parts_of(const DMat4& m) {
  Parts out{DVec3(m[3]), {glm::length(DVec3(m[0])), glm::length(DVec3(m[1])), glm::length(DVec3(m[2]))}, {0, 0, 0, 1}};
  const bool flat = !(out.scale.x > 0 && out.scale.y > 0 && out.scale.z > 0);
  if (flat) return out;
  DMat3 turn(m);
  for (int c = 0; c < 3; ++c) turn[c] /= out.scale[c];
  if (glm::dot(glm::cross(turn[0], turn[1]), turn[2]) < 0) {
    out.scale.x = -out.scale.x;
    turn[0] = -turn[0];
  }
  const auto q = glm::quat_cast(turn);
  out.rotation[0] = q.x, out.rotation[1] = q.y, out.rotation[2] = q.z, out.rotation[3] = q.w;
  return out;
}

void move(Imported::Node& node, Imported::Channel& channel, double seconds) {
  Parts parts = parts_of(matrix_of(node.local));
  const auto t = value_at(channel.translation_times, channel.translations, 3, seconds);
  const auto r = value_at(channel.rotation_times, channel.rotations, 4, seconds);
  const auto s = value_at(channel.scale_times, channel.scales, 3, seconds);
  if (t) parts.translation = {(*t)[0], (*t)[1], (*t)[2]};
  if (s) parts.scale = {(*s)[0], (*s)[1], (*s)[2]};
  if (r) std::ranges::copy(*r, parts.rotation);
  const auto local = compose_trs(parts.translation, parts.rotation, parts.scale);
  expect(local.has_value(), "a rotation is zero");
  for (int c = 0; c < 4; ++c)
    for (int row = 0; row < 4; ++row) node.local[static_cast<std::size_t>(4 * c + row)] = (*local)[c][row];
}

}  // namespace

void pose_nodes(Imported& imported, const PoseChoice& pose, const std::string& file, const WarningSink& warn) {
  expect(imported.animations.size() == imported.motion.clips.size(), "an animation has no name");
  std::vector<std::string> names;
  for (const Motion::Clip& clip : imported.motion.clips) names.push_back(plain_text(clip.name));
  const std::vector<bool> chosen = chosen_animations(names, pose, file);
  const auto quoted = [&](std::size_t a) { return "animation " + std::to_string(a) + " \"" + names[a] + '"'; };
  std::map<std::int64_t, std::size_t> movers;  // by node: the animation that moves it
  for (std::size_t a = 0; a < names.size(); ++a) {
    if (!chosen[a]) continue;
    std::vector<Imported::Channel>& channels = imported.animations[a];
    const auto moved = std::ranges::find_if(channels, [&](const auto& c) { return movers.contains(c.node); });
    if (moved != channels.end()) {
      if (warn)
        warn(file + ": " + quoted(a) + " is not played, since it moves a node that " + quoted(movers.at(moved->node)) +
             " moves; scene.animation plays it alone");
      continue;
    }
    for (Imported::Channel& channel : channels) {
      expect(channel.node >= 0 && channel.node < static_cast<std::int64_t>(imported.nodes.size()),
             "an animation moves no node");
      if (!movers.emplace(channel.node, a).second) continue;
      move(imported.nodes[static_cast<std::size_t>(channel.node)], channel, pose.seconds);
    }
  }
}

void bend_mesh(const Imported::Skin& skin, const std::vector<DMat4>& worlds, std::size_t own, MemoryBudget& memory,
               Mesh& mesh) {
  const std::size_t vertices = mesh.positions.size();
  const auto loan = memory.lend(vertices * (sizeof(DMat4) + sizeof(double)));
  std::vector<DMat4> sums(vertices, DMat4(0));
  std::vector<double> weights(vertices, 0);
  for (const Imported::Bone& bone : skin.bones) {
    expect(bone.node >= 0 && bone.node < static_cast<std::int64_t>(worlds.size()), "a bone has no node");
    expect(bone.vertices.size() == bone.weights.size(), "a bone has not one weight a vertex");
    const DMat4 m = worlds[static_cast<std::size_t>(bone.node)] * matrix_of(bone.bone_from_mesh);
    for (std::size_t i = 0; i < bone.vertices.size(); ++i) {
      const double weight = bone.weights[i];
      expect(bone.vertices[i] < vertices && std::isfinite(weight), "a bone moves no vertex");
      if (!(weight > 0)) continue;
      sums[bone.vertices[i]] += weight * m;
      weights[bone.vertices[i]] += weight;
    }
  }
  for (std::size_t v = 0; v < vertices; ++v) {
    const DMat4 m = weights[v] > 0 ? sums[v] / weights[v] : worlds[own];
    const Vec3 position(DVec3(m * glm::dvec4(DVec3(mesh.positions[v]), 1)));
    if (!(std::isfinite(position.x) && std::isfinite(position.y) && std::isfinite(position.z)))
      throw std::runtime_error("the pose moves vertex " + std::to_string(v) + " of mesh \"" + mesh.name +
                               "\" farther than single precision reaches");
    mesh.positions[v] = position;
    if (mesh.normals.empty()) continue;
    const Vec3 normal(moved_normal(m, DVec3(mesh.normals[v])));
    const bool finite = std::isfinite(normal.x) && std::isfinite(normal.y) && std::isfinite(normal.z);
    mesh.normals[v] = finite ? normal : Vec3(0, 0, 1);
  }
}

}  // namespace carousel::scene
