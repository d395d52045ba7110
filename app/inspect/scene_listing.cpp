#include "app/inspect/scene_listing.h"

#include <algorithm>
#include <cstdint>
#include <vector>

#include <fmt/format.h>

#include "report/text/number_text.h"
#include "report/text/singular.h"
#include "scene/model/node_bounds.h"
#include "shading/lights/sky_facts.h"

namespace carousel::app {

namespace {

using Json = nlohmann::ordered_json;

/// Lists the contents of the file, without the camera and the lights that the program adds.
struct Holdings {
  std::uint64_t triangles = 0, instanced = 0, spheres = 0, image_bytes = 0, materials = 0, lights = 0, cameras = 0;
};

Holdings holdings(const scene::Scene& s) {
  Holdings out{.triangles = s.unique_triangle_count(),
               .instanced = s.instanced_triangle_count(),
               .materials = s.materials.size() - (s.added.material ? 1 : 0),
               .lights = s.lights.size() - (s.added.sun ? 1 : 0),
               .cameras = s.cameras.size() - (s.added.camera ? 1 : 0)};
  for (const scene::Mesh& mesh : s.meshes) out.spheres += mesh.spheres.size();
  for (const scene::Image& image : s.images) out.image_bytes += image.rgba.size();
  return out;
}

Json vector_json(const Vec3& v) {
  return {v.x, v.y, v.z};
}

/// Null for a scene without a vertex.
Json bounds_json(const Aabb& box) {
  if (box.empty()) return nullptr;
  return {{"min", vector_json(box.lo)}, {"max", vector_json(box.hi)}};
}

Json motion_json(const scene::Motion& motion) {
  Json animations = Json::array();
  for (const scene::Motion::Clip& clip : motion.clips)
    animations.push_back({{"name", clip.name}, {"seconds", clip.seconds}, {"channels", clip.channels}});
  return {{"animations", animations}, {"skins", motion.skins}, {"morph_targets", motion.morph_targets}};
}

Json sky_json(const scene::SkyMap& map) {
  const shading::SkyFacts facts = shading::sky_facts(map);
  return {{"name", map.name},
          {"width", map.width},
          {"height", map.height},
          {"mean", vector_json(facts.mean)},
          {"most_luminance", facts.most},
          {"brightest_percent_share", facts.brightest_percent}};
}

std::string sky_text(const scene::SkyMap& map) {
  const shading::SkyFacts facts = shading::sky_facts(map);
  return fmt::format(
      "sky          {}: {} x {}, mean radiance {:.3g} {:.3g} {:.3g}, brightest luminance {:.3g}\n"
      "             {:.1f} % of its light comes from the brightest 1 % of the sphere\n",
      map.name, map.width, map.height, facts.mean.x, facts.mean.y, facts.mean.z, facts.most,
      100 * facts.brightest_percent);
}

Json nodes_json(const scene::Scene& s) {
  const std::vector<Aabb> boxes = scene::node_bounds(s);
  Json out = Json::array();
  for (std::size_t i = 0; i < boxes.size(); ++i)
    out.push_back({{"name", s.nodes[i].name}, {"instances", s.nodes[i].instances}, {"bounds", bounds_json(boxes[i])}});
  return out;
}

std::string cost_text(const report::EffectCost& cost) {
  std::string text;
  const auto add = [&](std::uint64_t count, const char* what) {
    if (count > 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, what);
  };
  add(cost.rays, "rays a path");
  add(cost.texture_reads, "lookups a hit");
  add(cost.path_state_bytes, "bytes a path");
  add(cost.cycles_per_hit, "cycles a hit");
  add(cost.cycles_per_path, "cycles a path");
  return text;
}

std::string vector_text(const Vec3& v) {
  return fmt::format("{:.5g} {:.5g} {:.5g}", v.x, v.y, v.z);
}

std::string bounds_text(const Aabb& box) {
  return box.empty() ? "nothing" : vector_text(box.lo) + " to " + vector_text(box.hi);
}

/// Lists the scene's animations, skins and morph targets. Empty for a scene that stands still.
std::string motion_text(const scene::Motion& motion) {
  if (!motion.any()) return "";
  std::string out = report::singular(fmt::format("motion       {} animations, {} skins, {} morph targets\n",
                                                 motion.clips.size(), motion.skins, motion.morph_targets));
  for (std::size_t i = 0; i < motion.clips.size(); ++i)
    out += fmt::format("             animation {}: \"{}\", {:.6g} s, {}\n", i, motion.clips[i].name,
                       motion.clips[i].seconds, report::singular(fmt::format("{} channels", motion.clips[i].channels)));
  return out;
}

std::string nodes_text(const scene::Scene& s) {
  constexpr std::size_t kShown = 40;
  if (s.nodes.empty()) return "";
  const std::vector<Aabb> boxes = scene::node_bounds(s);
  std::string out = fmt::format("\n{:<28}{:>10}   {}\n", "node", "instances", "bounds");
  for (std::size_t i = 0; i < std::min(boxes.size(), kShown); ++i)
    out += fmt::format("{:<28}{:>10}   {}\n", s.nodes[i].name, s.nodes[i].instances, bounds_text(boxes[i]));
  if (boxes.size() > kShown)
    out += report::singular(fmt::format("and {} more nodes, which --json lists\n", boxes.size() - kShown));
  return out;
}

}  // namespace

Json listing_json(const scene::Scene& s, const report::Shading& shading) {
  const Holdings h = holdings(s);
  Json effects = Json::array(), classes = Json::array();
  for (const report::Effect& e : shading.effects) {
    effects.push_back({{"name", e.name},
                       {"on", e.on},
                       {"called_for", e.called_for},
                       {"callers", e.callers},
                       {"why", e.why},
                       {"cost",
                        {{"rays", e.cost.rays},
                         {"texture_reads", e.cost.texture_reads},
                         {"path_state_bytes", e.cost.path_state_bytes},
                         {"cycles_per_hit", e.cost.cycles_per_hit},
                         {"cycles_per_path", e.cost.cycles_per_path}}}});
  }
  for (const report::ShaderClass& c : shading.classes)
    classes.push_back({{"name", c.name}, {"materials", c.materials}});
  Json out{
      {"scene",
       {{"name", s.name},
        {"triangles", h.triangles},
        {"instanced_triangles", h.instanced},
        {"spheres", h.spheres},
        {"meshes", s.meshes.size()},
        {"instances", s.instances.size()},
        {"materials", h.materials},
        {"textures", s.textures.size()},
        {"images", s.images.size()},
        {"image_bytes", h.image_bytes},
        {"lights", h.lights},
        {"cameras", h.cameras}}},
      {"motion", motion_json(s.motion)},
      {"bounds", bounds_json(s.bounds())},
      {"nodes", nodes_json(s)},
      {"made_up",
       {{"camera", s.added.camera ? s.cameras[0].name : ""}, {"sun", s.added.sun}, {"material", s.added.material}}},
      {"effects_choice", shading.effects_choice},
      {"effects", effects},
      {"classes", classes},
      {"path_state_bytes", shading.path_state_bytes},
      {"saved",
       {{"path_state_bytes", shading.saved.path_state_bytes},
        {"images_not_decoded", shading.saved.images_not_decoded}}}};
  if (!s.sky.map.empty()) out["scene"]["sky_map"] = sky_json(s.sky.map);
  return out;
}

std::string listing_text(const scene::Scene& s, const report::Shading& shading) {
  const Holdings h = holdings(s);
  std::string out = report::singular(
      fmt::format("scene        {}: {} triangles, {} with instances, {} spheres; {} meshes, {} instances\n"
                  "             {} materials, {} textures, {} images of {}, {} lights, {} cameras\n",
                  s.name, report::grouped(h.triangles), report::grouped(h.instanced), h.spheres, s.meshes.size(),
                  s.instances.size(), h.materials, s.textures.size(), s.images.size(),
                  report::bytes_text(h.image_bytes), h.lights, h.cameras));
  if (s.added.camera || s.added.sun)
    out += fmt::format("made up      {}{}{}\n",
                       !s.added.camera  ? ""
                       : s.added.inside ? "a camera that stands inside the model (the file has none)"
                                        : "a camera that shows the whole model (the file has none)",
                       s.added.camera && s.added.sun ? "; " : "",
                       s.added.sun ? "a sun (the file has no light that could show it)" : "");
  if (!s.sky.map.empty()) out += sky_text(s.sky.map);
  out += motion_text(s.motion);
  if (const Aabb box = s.bounds(); !box.empty()) out += fmt::format("bounds       {}\n", bounds_text(box));
  out += nodes_text(s);
  out += "\n";
  out += fmt::format("{:<28}{:<5}{:<52}{}\n", "effect", "", "cost", "why");
  for (const report::Effect& e : shading.effects)
    out += fmt::format("{:<28}{:<5}{:<52}{}\n", e.name, e.on ? "on" : "off", cost_text(e.cost), e.why);
  out += "\nsurfaces     ";
  for (const report::ShaderClass& c : shading.classes) out += fmt::format("{} {}   ", c.materials, c.name);
  out += fmt::format("\npath state   {} bytes, {} fewer than all effects take\n", shading.path_state_bytes,
                     shading.saved.path_state_bytes);
  if (shading.saved.images_not_decoded > 0)
    out += fmt::format("images       {} are read by no effect, and not decoded\n", shading.saved.images_not_decoded);
  return out;
}

}  // namespace carousel::app
