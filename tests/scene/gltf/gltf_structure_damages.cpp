#include "tests/scene/gltf/gltf_damage.h"

namespace carousel::scene {

namespace {

using Verdict = std::optional<Damage::Verdict>;
using Plant = std::function<Verdict(ModelFiles&)>;

/// Sets the value that a pointer names; the fault is there, or at `below` in it. The model must have the parent.
Plant set(const std::string& pointer, const Json& value, const std::string& message, const std::string& below = "") {
  return [=](ModelFiles& m) -> Verdict {
    const Json::json_pointer at(pointer);
    if (!m.json.contains(at.parent_pointer())) return std::nullopt;
    m.json[at] = value;
    return {{pointer + below, message}};
  };
}

/// Changes the first node that has a value at `key`; the fault is at `where` in it.
Plant on_node(const std::string& key, const std::string& where, const std::string& message,
              const std::function<void(ModelFiles&, Json& node)>& change) {
  return [=](ModelFiles& m) -> Verdict {
    Json& nodes = m.json["nodes"];
    for (std::size_t i = 0; i < nodes.size(); ++i) {
      if (!nodes[i].contains(Json::json_pointer(key))) continue;
      change(m, nodes[i]);
      return {{"/nodes/" + std::to_string(i) + where, message}};
    }
    return std::nullopt;
  };
}

/// The index of a new node.
std::size_t add_node(ModelFiles& m, const Json& node) {
  m.json["nodes"].push_back(node);
  return m.json["nodes"].size() - 1;
}

std::string add_root(ModelFiles& m, const Json& node) {
  Json& roots = m.json["scenes"][0]["nodes"];
  roots.push_back(node);
  return "/scenes/0/nodes/" + std::to_string(roots.size() - 1);
}

Json some_child(const ModelFiles& m) {
  for (const Json& node : m.json["nodes"])
    if (node.contains("children")) return node["children"][0];
  return nullptr;
}

const std::string kInstances = "/extensions/EXT_mesh_gpu_instancing/attributes";
const std::string kLights = "/extensions/KHR_lights_punctual/lights";

std::vector<Damage> document_damages() {
  return {
      {"no asset",
       [](ModelFiles& m) -> Verdict {
         m.json.erase("asset");
         return {{"/asset", "missing"}};
       }},
      {"glTF 1.0", set("/asset/version", "1.0", "only 2.0 is read")},
      {"at least glTF 2.1", set("/asset/minVersion", "2.1", "only 2.0 is read")},
      {"version as a number", set("/asset/version", 2, "expected a string")},
      {"unknown extension required",
       set("/extensionsRequired", Json::array({"VENDOR_unheard_of"}), "requires VENDOR_unheard_of", "/0")},
      {"Basis Universal required",
       set("/extensionsRequired", Json::array({"KHR_texture_basisu"}), "KHR_texture_basisu", "/0")},
      {"object for array", set("/nodes", Json::object(), "expected an array")},
      {"array for object", set("/meshes/0/primitives/0/attributes", Json::array(), "expected an object")},
      {"text for number", set("/accessors/0/count", "many", "expected an integer")},
      {"null for array", set("/meshes/0/primitives", nullptr, "expected an array")},
      {"number beyond a float", set("/nodes/0/scale", {1, 1e300, 1}, "expected a number from", "/1")},
      {"unknown mode", set("/meshes/0/primitives/0/mode", 7, "expected an integer from 0 to 6")},
      {"matrix of two", set("/nodes/0/matrix", {1, 2}, "expected an array of 16")},
  };
}

std::vector<Damage> node_damages() {
  return {
      {"own child", set("/nodes/0/children", {0}, "node 0 is its own child", "/0")},
      {"cycle of three",
       [](ModelFiles& m) -> Verdict {
         const std::size_t a = m.json["nodes"].size();
         for (const std::size_t child : {a + 1, a + 2, a}) add_node(m, {{"children", {child}}});
         return {{"/nodes/" + std::to_string(a) + "/children", "is its own ancestor"}};
       }},
      {"two parents",
       [](ModelFiles& m) -> Verdict {
         const std::size_t second = add_node(m, {{"children", {some_child(m)}}});
         return {{"/nodes/" + std::to_string(second) + "/children/0", "has several parents"}};
       }},
      {"projective matrix",
       on_node("/mesh", "/matrix", "not an affine transform",
               [](ModelFiles&, Json& node) { node["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 1}; })},
      {"rotation by nothing", on_node("/mesh", "/rotation", "length zero",
                                      [](ModelFiles&, Json& node) {
                                        node.erase("matrix");
                                        node["rotation"] = {0, 0, 0, 0};
                                      })},
      {"transform that overflows",
       [](ModelFiles& m) -> Verdict {
         const std::size_t inner = add_node(m, {{"mesh", 0}, {"scale", {1e30, 1, 1}}});
         add_root(m, add_node(m, {{"children", {inner}}, {"scale", {1e30, 1, 1}}}));
         return {{"/nodes/" + std::to_string(inner), "too large for single precision"}};
       }},
      {"nothing to see",
       [](ModelFiles& m) -> Verdict {
         for (Json& node : m.json["nodes"]) node.erase("mesh");
         return {{"", "shows no triangles"}};
       }},
  };
}

std::vector<Damage> extra_damages() {
  return {
      {"instances of different number",
       on_node(kInstances + "/SCALE", kInstances + "/TRANSLATION", "other attributes have",
               [](ModelFiles& m, Json& node) {
                 const Json& attributes = node[Json::json_pointer(kInstances)];
                 m.json["accessors"][attributes["TRANSLATION"].get<std::size_t>()]["count"] = 1;
               })},
      {"instance turned by nothing",
       on_node(kInstances + "/ROTATION", kInstances + "/ROTATION", "the quaternion of instance 9 has length zero",
               [](ModelFiles& m, Json& node) {
                 const Json& attributes = node[Json::json_pointer(kInstances)];
                 put(m.element(attributes["ROTATION"], 9), std::uint64_t{0});
               })},
      {"light too bright", on_node("/extensions/KHR_lights_punctual", "", "too bright",
                                   [](ModelFiles& m, Json&) {
                                     Json& light = m.json[Json::json_pointer(kLights)][0];
                                     light["color"] = {1e30, 1, 1};
                                     light["intensity"] = 1e30;
                                   })},
      {"spot inside out", set(kLights + "/0/spot/innerConeAngle", 1.5, "less than outerConeAngle")},
      {"light of no kind", set(kLights + "/0/type", "moon", "expected one of")},
      {"camera without its numbers", set("/cameras/0", {{"type", "perspective"}}, "missing", "/perspective")},
      {"flat camera", on_node("/camera", "", "no view direction",
                              [](ModelFiles&, Json& node) {
                                node.erase("matrix");
                                node["scale"] = {0, 0, 0};
                              })},
  };
}

}  // namespace

std::vector<Damage> structure_damages() {
  std::vector<Damage> all;
  for (std::vector<Damage> some : {document_damages(), node_damages(), extra_damages()})
    all.insert(all.end(), some.begin(), some.end());
  return all;
}

}  // namespace carousel::scene
