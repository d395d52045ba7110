#include "scene/gltf/hierarchy.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

namespace carousel::scene {

namespace {

/// Rounded to float. A map that floats do not hold becomes one that no structure can be placed by.
Affine rounded_or_flat(const DMat4& m) {
  Affine out;
  bool finite = true;
  for (int row = 0; row < 3; ++row) {
    for (int c = 0; c < 3; ++c) finite &= std::isfinite(out.linear[c][row] = static_cast<float>(m[c][row]));
    finite &= std::isfinite(out.translation[row] = static_cast<float>(m[3][row]));
  }
  return finite ? out : Affine{Mat3(0.0f), Vec3(0)};
}

}  // namespace

void Hierarchy::Digest::add(const DMat4& m) {
  for (int c = 0; c < 4; ++c)
    for (int row = 0; row < 3; ++row) {
      const std::uint64_t bits = std::bit_cast<std::uint64_t>(m[c][row] + 0.0);  // -0 and 0 are one number
      a = (std::rotl(a, 23) ^ bits) * 0xbf58476d1ce4e5b9u;
      a ^= a >> 31;
      b = (std::rotl(b, 29) + bits) * 0x94d049bb133111ebu;
      b ^= b >> 29;
    }
}

std::size_t Hierarchy::add(std::size_t parent, const DMat4& local, const DMat4& world, std::size_t instances) {
  entries_.push_back({parent, local, world, instances, 0, DMat4(1), {}});
  return entries_.size() - 1;
}

void Hierarchy::add_own(const DMat4& node_from_model) {
  Entry& node = entries_.back();
  ++node.own;
  node.only_own = node_from_model;
  node.places.add(node_from_model);
}

/// The results of the walk from the last node to the first, children before their parents.
struct Hierarchy::Finding {
  struct Node {
    std::vector<std::size_t> children;  // with anything in them, in order
    Content content;
    std::optional<std::uint32_t> group;  // that the node itself is
  };
  std::vector<Node> nodes;
  std::map<Digest, std::vector<std::uint32_t>> known;  // groups by the places of their members
};

void Hierarchy::write(Scene& scene) const {
  Finding found;
  found.nodes.resize(entries_.size());
  for (std::size_t i = entries_.size(); i-- > 0;) {
    const Entry& entry = entries_[i];
    Finding::Node& node = found.nodes[i];
    std::reverse(node.children.begin(), node.children.end());  // they were met from the last to the first
    const std::size_t members = entry.own + node.children.size();
    if (members == 0) continue;
    Content& content = node.content;
    content.empty = false;
    if (members == 1 && entry.own == 1) {
      content.member = {false, scene.instances[entry.first_instance].mesh.value};
      content.parent_from_member = entry.local * entry.only_own;
    } else if (members == 1) {
      const Content& only = found.nodes[node.children.front()].content;
      content.member = only.member;
      content.parent_from_member = entry.local * only.parent_from_member;
    } else {
      Group group;
      group.members.reserve(members);
      for (std::size_t k = 0; k < entry.own; ++k)
        group.members.push_back({false, scene.instances[entry.first_instance + k].mesh.value});
      Digest places = entry.places;
      for (const std::size_t child : node.children) {
        group.members.push_back(found.nodes[child].content.member);
        places.add(found.nodes[child].content.parent_from_member);
      }
      std::vector<std::uint32_t>& alike = found.known[places];
      for (const std::uint32_t id : alike)
        if (scene.groups[id].members == group.members) node.group = id;
      if (!node.group) {
        node.group = static_cast<std::uint32_t>(scene.groups.size());
        alike.push_back(*node.group);
        scene.groups.push_back(std::move(group));
      }
      content.member = {true, *node.group};
      content.parent_from_member = entry.local;
    }
    if (entry.parent != kWorld) found.nodes[entry.parent].children.push_back(i);
  }

  struct Place {
    std::uint32_t placement = kNoPlacement, member = 0;
  };
  std::vector<Place> places(entries_.size());  // that a node's content takes
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    const Entry& entry = entries_[i];
    const Finding::Node& node = found.nodes[i];
    Place next = places[i];
    if (node.group) {
      const auto placement = static_cast<std::uint32_t>(scene.placements.size());
      scene.placements.push_back({*node.group, rounded_or_flat(entry.world), next.placement, next.member});
      next = {placement, 0};
    }
    for (std::size_t k = 0; k < entry.own; ++k, ++next.member) {
      Instance& instance = scene.instances[entry.first_instance + k];
      instance.placement = next.placement;
      instance.member = next.member;
    }
    for (const std::size_t child : node.children) {
      places[child] = next;
      ++next.member;
    }
  }
}

}  // namespace carousel::scene
