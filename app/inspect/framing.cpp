#include "app/inspect/framing.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <vector>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <spdlog/spdlog.h>

#include "core/system/error.h"
#include "core/text/edit_distance.h"
#include "report/text/number_text.h"
#include "report/text/singular.h"
#include "scene/model/fitted_camera.h"
#include "scene/model/node_bounds.h"

namespace carousel::app {

namespace {

using Json = nlohmann::ordered_json;

[[noreturn]] void no_such_node(const scene::Scene& scene, std::string_view name) {
  constexpr std::size_t kShown = 12;
  std::vector<std::string> names;
  for (const scene::NamedNode& node : scene.nodes) names.push_back(node.name);
  std::string message = fmt::format("no node of {} that shows anything is called '{}'; ", scene.name, name);
  if (names.empty())
    message += "none of them has a name";
  else if (const auto near = nearest_name(name, names))
    message += fmt::format("did you mean {}?", *near);
  else
    message +=
        fmt::format("expected one of {}{}", fmt::join(std::span(names).first(std::min(names.size(), kShown)), ", "),
                    names.size() > kShown ? ", and others that carousel inspect --json lists" : "");
  throw ConfigError("--frame", message);
}

std::string list_text(const Vec3& v) {
  return fmt::format("[{}, {}, {}]", report::float_text(v.x), report::float_text(v.y), report::float_text(v.z));
}

}  // namespace

Framing frame_node(const scene::Scene& scene, std::string_view name, float aspect) {
  constexpr float kFarthest = 1e9f;  // of camera.eye
  const auto found = std::ranges::find(scene.nodes, name, &scene::NamedNode::name);
  if (found == scene.nodes.end()) no_such_node(scene, name);
  if (const auto alike = std::ranges::count(scene.nodes, name, &scene::NamedNode::name); alike > 1)
    spdlog::warn("{}: {} nodes are called '{}'; the first of them is framed", scene.name, alike, name);
  const scene::Camera camera =
      scene::fitted_camera(scene, aspect, std::span(scene.instances).subspan(found->first_instance, found->instances));
  Framing out;
  out.node = found->name;
  out.instances = found->instances;
  out.bounds = scene::node_bounds(scene)[static_cast<std::size_t>(found - scene.nodes.begin())];
  const DVec3 eye(camera.position), back(camera.back);
  // The camera looks past the middle of the bounds where the node does not fill them evenly.
  const double distance = glm::dot(eye - DVec3(out.bounds.centre()), back);
  out.eye = camera.position;
  out.target = Vec3(eye - distance * back);
  out.up = Vec3(0, 1, 0);
  out.field_of_view = camera.yfov * 180 / std::numbers::pi_v<float>;
  for (const Vec3& p : {out.eye, out.target})
    for (int axis = 0; axis < 3; ++axis)
      if (!(std::fabs(p[axis]) <= kFarthest))
        throw ConfigError("--frame", fmt::format("'{}' is too large or too far away: its camera would stand at {}, "
                                                 "outside the range of camera.eye",
                                                 name, list_text(out.eye)));
  return out;
}

std::string framing_yaml(const Framing& framing) {
  return fmt::format(
      "# sees all of '{}' ({}, {} to {})\n"
      "camera:\n  eye: {}\n  target: {}\n  up: {}\n  field_of_view: {}\n",
      framing.node, report::singular(fmt::format("{} instances", framing.instances)), list_text(framing.bounds.lo),
      list_text(framing.bounds.hi), list_text(framing.eye), list_text(framing.target), list_text(framing.up),
      report::float_text(framing.field_of_view));
}

Json framing_json(const Framing& framing) {
  const auto list = [](const Vec3& v) { return Json{v.x, v.y, v.z}; };
  return {{"node", framing.node},
          {"instances", framing.instances},
          {"bounds", {{"min", list(framing.bounds.lo)}, {"max", list(framing.bounds.hi)}}},
          {"camera",
           {{"eye", list(framing.eye)},
            {"target", list(framing.target)},
            {"up", list(framing.up)},
            {"field_of_view", framing.field_of_view}}}};
}

}  // namespace carousel::app
