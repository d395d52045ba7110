#include "scene/gltf/pose/animation.h"

#include <algorithm>
#include <charconv>
#include <map>
#include <set>
#include <string_view>
#include <utility>

#include "core/system/error.h"
#include "core/system/plain_text.h"
#include "core/text/edit_distance.h"
#include "scene/gltf/pose/track.h"

namespace carousel::scene {

namespace {

std::string name_of_animation(const Json& json, std::size_t index) {
  const Json& animation = json["animations"][index];
  if (!animation.is_object() || !animation.contains("name") || !animation["name"].is_string()) return "";
  return plain_text(animation["name"].get<std::string>());
}

std::size_t animation_count(const Json& json) {
  const auto entry = json.find("animations");
  return entry != json.end() && entry->is_array() ? entry->size() : 0;
}

/// What a channel moves.
enum class Moved { kTranslation, kRotation, kScale, kWeights };

std::optional<Moved> moved_by(std::string_view path) {
  constexpr std::pair<std::string_view, Moved> kPaths[] = {{"translation", Moved::kTranslation},
                                                           {"rotation", Moved::kRotation},
                                                           {"scale", Moved::kScale},
                                                           {"weights", Moved::kWeights}};
  for (const auto& [name, moved] : kPaths)
    if (name == path) return moved;
  return std::nullopt;
}

AccessorUse use_of(Moved moved) {
  switch (moved) {
    case Moved::kTranslation:
      return AccessorUse::kTranslation;
    case Moved::kRotation:
      return AccessorUse::kTurn;
    case Moved::kScale:
      return AccessorUse::kScale;
    case Moved::kWeights:
      return AccessorUse::kMorphWeight;
  }
  return AccessorUse::kMorphWeight;
}

class Player {
 public:
  Player(const GltfDocument& document, const AccessorTable& accessors, const ImportBudget& budget,
         const WarningSink& warn, tinygltf::Model& model)
      : document_(document), accessors_(accessors), budget_(budget), warn_(warn), model_(model) {}

  void play(std::size_t animation, double seconds) {
    const Json& json = document_.json["animations"][animation];
    const std::string path = json_path("/animations", animation);
    if (const auto other = moved_before(animation)) {
      say(path + ": " + quoted(animation) + " is not played, since it moves node " + std::to_string(other->first) +
          " as " + quoted(other->second) + " does; scene.animation plays it alone");
      return;
    }
    std::set<std::pair<std::size_t, Moved>> done;
    std::size_t ignored = 0;
    for (std::size_t c = 0; c < json["channels"].size(); ++c) {
      const Json& channel = json["channels"][c];
      const std::string where = json_path(json_path(path, "channels"), c);
      const Json& target = channel["target"];
      const auto& moves = target["path"].get_ref<const std::string&>();
      if (moves == "pointer") {
        ++ignored;
        continue;
      }
      const auto moved = moved_by(moves);
      const std::string target_path = json_path(where, "target");
      if (!moved)
        document_.fail(json_path(target_path, "path"),
                       "expected one of translation rotation scale weights, found \"" + moves + '"');
      if (!target.contains("node")) continue;  // specification, 3.11: such a channel is to be ignored
      const auto node = target["node"].get<std::size_t>();
      if (!done.insert({node, *moved}).second)
        document_.fail(target_path, "another channel of this animation moves the same");
      movers_.emplace(node, animation);
      set(node, *moved,
          track(json["samplers"][channel["sampler"].get<std::size_t>()],
                json_path(json_path(path, "samplers"), channel["sampler"].get<std::size_t>()), *moved,
                width_of(node, *moved, target_path))
              .at(seconds),
          target_path);
    }
    if (ignored > 0)
      say(path + ": " + std::to_string(ignored) + " channels of KHR_animation_pointer, which is not read, are ignored");
  }

 private:
  void say(const std::string& warning) const {
    if (warn_) warn_(document_.file + ": " + warning);
  }

  std::string quoted(std::size_t animation) const {
    const std::string name = name_of_animation(document_.json, animation);
    return "animation " + std::to_string(animation) + (name.empty() ? "" : " \"" + name + '"');
  }

  /// A node of the animation that another one has moved, and the other one.
  std::optional<std::pair<std::size_t, std::size_t>> moved_before(std::size_t animation) const {
    for (const Json& channel : document_.json["animations"][animation]["channels"]) {
      if (!channel["target"].contains("node")) continue;
      if (const auto mover = movers_.find(channel["target"]["node"].get<std::size_t>()); mover != movers_.end())
        return *mover;
    }
    return std::nullopt;
  }

  std::size_t width_of(std::size_t node, Moved moved, const std::string& path) const {
    if (moved != Moved::kWeights) return moved == Moved::kRotation ? 4 : 3;
    const int mesh = model_.nodes[node].mesh;
    const std::size_t targets = mesh >= 0 ? morph_targets(document_, model_, static_cast<std::size_t>(mesh)) : 0;
    if (targets == 0) document_.fail(path, "node " + std::to_string(node) + " has no mesh with morph targets");
    return targets;
  }

  Track track(const Json& sampler, const std::string& path, Moved moved, std::size_t width) const {
    const auto input = sampler["input"].get<std::size_t>(), output = sampler["output"].get<std::size_t>();
    const std::string input_path = json_path(path, "input"), output_path = json_path(path, "output");
    accessors_.check_use(input, AccessorUse::kTime, input_path);
    accessors_.check_use(output, use_of(moved), output_path);
    const std::string how = sampler.value("interpolation", std::string("LINEAR"));
    Track out;
    out.width = width;
    out.rotation = moved == Moved::kRotation;
    out.interpolation = how == "STEP"          ? Interpolation::kStep
                        : how == "CUBICSPLINE" ? Interpolation::kCubicSpline
                                               : Interpolation::kLinear;
    const std::uint64_t values =
        accessors_.count(input) * (how == "CUBICSPLINE" ? 3 : 1) * (moved == Moved::kWeights ? width : std::size_t{1});
    if (accessors_.count(output) != values) {
      document_.fail(output_path, "accessor " + std::to_string(output) + " has " +
                                      std::to_string(accessors_.count(output)) + " elements; the " +
                                      std::to_string(accessors_.count(input)) + " times of this sampler need " +
                                      std::to_string(values));
    }
    const auto loan = budget_.lend(
        (accessors_.count(input) + values * static_cast<std::size_t>(accessors_.components(output))) * sizeof(float),
        path, "the sampler");
    out.times = accessors_.floats(input, input_path);
    for (std::size_t i = 1; i < out.times.size(); ++i)
      if (!(out.times[i] > out.times[i - 1]))
        document_.fail(input_path, "element " + std::to_string(i) + " of accessor " + std::to_string(input) +
                                       " is not greater than the one before");
    out.values = accessors_.floats(output, output_path);
    if (out.rotation) check_rotations(out, output, output_path);
    return out;
  }

  void check_rotations(const Track& track, std::size_t accessor, const std::string& path) const {
    const bool cubic = track.interpolation == Interpolation::kCubicSpline;
    for (std::size_t i = cubic ? 4 : 0; i < track.values.size(); i += cubic ? 12 : 4) {
      const float* const q = &track.values[i];
      if (q[0] == 0 && q[1] == 0 && q[2] == 0 && q[3] == 0)
        document_.fail(path, "the quaternion of element " + std::to_string(i / 4) + " of accessor " +
                                 std::to_string(accessor) + " has length zero");
    }
  }

  void set(std::size_t index, Moved moved, std::vector<double> value, const std::string& path) {
    tinygltf::Node& node = model_.nodes[index];
    if (moved != Moved::kWeights && !node.matrix.empty())
      document_.fail(path, "node " + std::to_string(index) + " has a matrix, which cannot be animated");
    switch (moved) {
      case Moved::kTranslation:
        node.translation = std::move(value);
        break;
      case Moved::kRotation:
        node.rotation = std::move(value);
        break;
      case Moved::kScale:
        node.scale = std::move(value);
        break;
      case Moved::kWeights:
        node.weights = std::move(value);
        break;
    }
  }

  const GltfDocument& document_;
  const AccessorTable& accessors_;
  const ImportBudget& budget_;
  const WarningSink& warn_;
  tinygltf::Model& model_;
  std::map<std::size_t, std::size_t> movers_;  ///< by node: the animation that moves it
};

}  // namespace

std::vector<bool> chosen_animations(const Json& json, const PoseChoice& pose, const std::string& file) {
  const std::size_t count = animation_count(json);
  std::vector<std::string> names;
  for (std::size_t i = 0; i < count; ++i) names.push_back(name_of_animation(json, i));
  return chosen_animations(names, pose, file);
}

std::vector<bool> chosen_animations(const std::vector<std::string>& names, const PoseChoice& pose,
                                    const std::string& file) {
  const std::size_t count = names.size();
  std::vector<bool> out(count, !pose.animation.has_value());
  if (!pose.animation) return out;
  if (const auto named = std::ranges::find(names, *pose.animation); named != names.end()) {
    out[static_cast<std::size_t>(named - names.begin())] = true;
    return out;
  }
  std::size_t index = 0;
  const char* const end = pose.animation->data() + pose.animation->size();
  if (const auto [stop, error] = std::from_chars(pose.animation->data(), end, index);
      error == std::errc{} && stop == end && index < count) {
    out[index] = true;
    return out;
  }
  std::string expected = count == 0 ? "; the file has no animations" : "; expected one of 0";
  if (count > 1) expected += " to " + std::to_string(count - 1);
  constexpr std::size_t kShown = 12;
  for (std::size_t i = 0; i < std::min(count, kShown); ++i)
    if (!names[i].empty()) expected += ", " + names[i];
  const auto near = nearest_name(*pose.animation, names);
  throw ConfigError("scene.animation.name", "no animation of " + file + " is called '" + *pose.animation + "'" +
                                                expected + (near ? "; did you mean " + *near + "?" : ""));
}

void pose_nodes(const GltfDocument& document, const AccessorTable& accessors, const ImportBudget& budget,
                const PoseChoice& pose, const WarningSink& warn, tinygltf::Model& model) {
  Player player(document, accessors, budget, warn, model);
  for (std::size_t i = 0; i < document.posing.animations.size(); ++i)
    if (document.posing.animations[i]) player.play(i, pose.seconds);
}

Motion motion_of(const GltfDocument& document, const AccessorTable& accessors) {
  Motion out;
  const Json& json = document.json;
  for (std::size_t i = 0; i < animation_count(json); ++i) {
    const Json& animation = json["animations"][i];
    Motion::Clip clip{name_of_animation(json, i), 0, animation["channels"].size()};
    for (const Json& sampler : animation["samplers"]) {
      const auto input = sampler["input"].get<std::size_t>();
      if (accessors.component(input) == Component::kFloat && accessors.components(input) == 1)
        clip.seconds = std::max(clip.seconds, accessors.last_scalar(input));
    }
    out.clips.push_back(std::move(clip));
  }
  if (json.contains("skins")) out.skins = json["skins"].size();
  out.morph_targets = document.morph_targets;
  return out;
}

std::size_t morph_targets(const GltfDocument& document, const tinygltf::Model& model, std::size_t mesh) {
  const std::vector<tinygltf::Primitive>& primitives = model.meshes[mesh].primitives;
  for (std::size_t p = 1; p < primitives.size(); ++p) {
    if (primitives[p].targets.size() == primitives[0].targets.size()) continue;
    document.fail(json_path(json_path(json_path("/meshes", mesh), "primitives"), p) + "/targets",
                  "expected " + std::to_string(primitives[0].targets.size()) +
                      " morph targets, as the first primitive has, found " +
                      std::to_string(primitives[p].targets.size()));
  }
  return primitives.empty() ? 0 : primitives[0].targets.size();
}

}  // namespace carousel::scene
