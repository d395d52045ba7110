#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "scene/gltf/document/checks.h"
#include "scene/gltf/document/uses.h"

namespace carousel::scene {

namespace {

const Json& entries(const Json& json, const char* key) {
  static const Json none = Json::array();
  const auto entry = json.find(key);
  return entry == json.end() ? none : *entry;
}

void check_buffer_views(const GltfDocument& document) {
  const Json& buffers = entries(document.json, "buffers");
  const Json& views = entries(document.json, "bufferViews");
  for (std::size_t i = 0; i < views.size(); ++i) {
    const std::string path = json_path("/bufferViews", i);
    const auto buffer = views[i]["buffer"].get<std::size_t>();
    const auto size = buffers[buffer]["byteLength"].get<std::uint64_t>();
    const auto offset = views[i].value("byteOffset", std::uint64_t{0});
    const auto length = views[i]["byteLength"].get<std::uint64_t>();  // all at most 2^53: sums do not wrap
    if (offset + length > size) {
      document.fail(path, "bytes " + std::to_string(offset) + " to " + std::to_string(offset + length) +
                              " lie outside buffer " + std::to_string(buffer) + ", which has " + std::to_string(size));
    }
    const int stride = views[i].value("byteStride", 0);
    if (stride % 4 != 0) {
      document.fail(json_path(path, "byteStride"), "expected a multiple of 4, found " + std::to_string(stride));
    }
  }
}

/// Refuses a fault of an entry that is used, and warns of another.
void report(const GltfDocument& document, const WarningSink& warn, bool used, const std::string& path,
            const std::string& message) {
  if (used) document.fail(path, message);
  if (warn) warn(document.file + ": " + path + ": " + message + "; ignored, since nothing that is shown uses it");
}

void check_details(const GltfDocument& document, const WarningSink& warn) {
  const Json& json = document.json;
  const Uses uses = uses_of(json, document.posing);
  const Json& images = entries(json, "images");
  for (std::size_t i = 0; i < images.size(); ++i) {
    if (images[i].contains("uri") == images[i].contains("bufferView"))
      report(document, warn, uses.images[i], json_path("/images", i), "expected exactly one of uri and bufferView");
  }
  const Json& cameras = entries(json, "cameras");
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const auto& type = cameras[i]["type"].get_ref<const std::string&>();
    if (!cameras[i].contains(type))
      report(document, warn, uses.cameras[i], json_path(json_path("/cameras", i), type), "missing");
  }
  const Json& animations = entries(json, "animations");
  for (std::size_t a = 0; a < animations.size(); ++a) {
    const std::size_t samplers = animations[a]["samplers"].size();
    const Json& channels = animations[a]["channels"];
    for (std::size_t c = 0; c < channels.size(); ++c) {
      if (channels[c]["sampler"].get<std::size_t>() >= samplers) {
        report(document, warn, uses.animations[a],
               json_path(json_path(json_path(json_path("/animations", a), "channels"), c), "sampler"),
               "expected an index into this animation's samplers, which has " + std::to_string(samplers) +
                   " entries, found " + channels[c]["sampler"].dump());
      }
    }
  }
}

/// Checks that every accessor of indices has data. (Attributes without data are zeros.)
void check_primitives(const GltfDocument& document) {
  const Json& accessors = entries(document.json, "accessors");
  const Json& meshes = entries(document.json, "meshes");
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    const Json& primitives = meshes[m]["primitives"];
    for (std::size_t p = 0; p < primitives.size(); ++p) {
      if (!primitives[p].contains("indices")) continue;
      if (primitives[p].contains(Json::json_pointer("/extensions/KHR_draco_mesh_compression"))) continue;
      const Json& index = primitives[p]["indices"];
      const Json& accessor = accessors[index.get<std::size_t>()];
      if (accessor.contains("bufferView") || accessor.contains("sparse")) continue;
      document.fail(json_path(json_path(json_path(json_path("/meshes", m), "primitives"), p), "indices"),
                    "accessor " + index.dump() + " has no data");
    }
  }
}

/// Checks that a node with a sphere has no mesh, since the sphere takes its place.
void check_spheres(const GltfDocument& document) {
  const Json& nodes = entries(document.json, "nodes");
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (!nodes[i].contains("mesh") || !nodes[i].contains(Json::json_pointer("/extras/carousel_sphere"))) continue;
    document.fail(json_path("/nodes", i) + "/extras/carousel_sphere", "the node has a mesh already");
  }
}

void check_lights(const GltfDocument& document) {
  const Json::json_pointer pointer("/extensions/KHR_lights_punctual/lights");
  if (!document.json.contains(pointer)) return;
  const Json& lights = document.json.at(pointer);
  for (std::size_t i = 0; i < lights.size(); ++i) {
    if (lights[i]["type"] != "spot") continue;
    const std::string path = json_path(json_path(pointer.to_string(), i), "spot");
    const auto spot = lights[i].find("spot");
    if (spot == lights[i].end()) document.fail(path, "missing");
    if (spot->value("innerConeAngle", 0.0) >= spot->value("outerConeAngle", 0.7853981633974483)) {
      document.fail(json_path(path, "innerConeAngle"), "expected less than outerConeAngle");
    }
  }
}

std::string node_name(std::size_t node) {
  return "node " + std::to_string(node);
}

using Parents = std::vector<std::optional<std::size_t>>;

/// Checks that every node has at most one parent and that no node is its own ancestor; then the roots span all nodes.
Parents check_nodes(const GltfDocument& document) {
  const Json& nodes = entries(document.json, "nodes");
  Parents parents(nodes.size());
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const Json& children = entries(nodes[i], "children");
    for (std::size_t c = 0; c < children.size(); ++c) {
      const auto child = children[c].get<std::size_t>();
      const std::string path = json_path(json_path(json_path("/nodes", i), "children"), c);
      if (child == i) document.fail(path, node_name(i) + " is its own child: the nodes form a cycle");
      if (parents[child]) {
        document.fail(
            path, node_name(child) + " has several parents: " + node_name(*parents[child]) + " and " + node_name(i));
      }
      parents[child] = i;
    }
  }
  // With one parent each, a walk upwards ends at a root or runs in a circle. Each node is visited once.
  std::vector<std::size_t> seen_from(nodes.size(), nodes.size());
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    for (std::size_t at = i; seen_from[at] == nodes.size(); at = *parents[at]) {
      seen_from[at] = i;
      if (!parents[at]) break;
      if (seen_from[*parents[at]] == i) {
        document.fail(json_path(json_path("/nodes", *parents[at]), "children"),
                      node_name(at) + " is its own ancestor: the nodes form a cycle");
      }
    }
  }
  return parents;
}

/// Removes from the scenes' roots those that are named twice, and those below another root, which shows them.
void check_roots(GltfDocument& document, const Parents& parents, const WarningSink& warn) {
  const auto told = [&](const std::string& path, const std::string& fault) {
    if (warn) warn(document.file + ": " + path + ": " + fault);
  };
  if (!document.json.contains("scenes")) return;
  Json& scenes = document.json["scenes"];
  for (std::size_t s = 0; s < scenes.size(); ++s) {
    if (!scenes[s].contains("nodes")) continue;
    Json& roots = scenes[s]["nodes"];
    std::vector<bool> named(parents.size()), kept(parents.size());
    for (const Json& root : roots) named[root.get<std::size_t>()] = true;
    Json out = Json::array();
    for (std::size_t r = 0; r < roots.size(); ++r) {
      const auto root = roots[r].get<std::size_t>();
      const std::string path = json_path(json_path(json_path("/scenes", s), "nodes"), r);
      bool below_another = false;
      for (auto at = parents[root]; at && !below_another; at = parents[*at]) below_another = named[*at];
      if (kept[root]) {
        told(path, node_name(root) + " is named twice; it is shown once");
      } else if (below_another) {
        told(path, node_name(root) + " is not a root: it is a child of " + node_name(*parents[root]) +
                       ", and is shown there once");
      } else {
        if (parents[root])
          told(path, node_name(root) + " is not a root: it is a child of " + node_name(*parents[root]) +
                         ", which the scene does not show");
        kept[root] = true;
        out.push_back(root);
      }
    }
    roots = std::move(out);
  }
}

}  // namespace

void check_links(GltfDocument& document, const WarningSink& warn) {
  check_buffer_views(document);
  check_details(document, warn);
  check_primitives(document);
  check_lights(document);
  check_spheres(document);
  check_roots(document, check_nodes(document), warn);
}

}  // namespace carousel::scene
