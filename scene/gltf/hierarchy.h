#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/types/vec.h"
#include "scene/model/scene.h"

namespace carousel::scene {

/// Finds the groups in a tree of nodes: a node below which there are several instances, of its own or of its children,
/// is a group, and nodes with the same meshes and groups in the same places below them are the same group. A node with
/// one member only is none: its member takes its place.
class Hierarchy {
 public:
  static constexpr std::size_t kWorld = std::numeric_limits<std::size_t>::max();

  /// A node below the entry `parent`, or kWorld, in depth-first order, parents first. Its own instances follow those
  /// `instances` that there are. Returns its entry.
  std::size_t add(std::size_t parent, const DMat4& local, const DMat4& world, std::size_t instances);
  /// An instance of the newest entry's node.
  void add_own(const DMat4& node_from_model);
  /// Writes groups and placements, and those of the instances. To be called once, after all nodes.
  void write(Scene& scene) const;

 private:
  /// Two numbers drawn from matrices: equal for equal ones.
  struct Digest {
    std::uint64_t a = 0x9e3779b97f4a7c15u, b = 0xc2b2ae3d27d4eb4fu;
    void add(const DMat4& m);
    friend auto operator<=>(const Digest&, const Digest&) = default;
  };
  struct Entry {
    std::size_t parent;
    DMat4 local, world;
    std::size_t first_instance;
    std::size_t own = 0;  ///< instances
    DMat4 only_own{1};    ///< place of the node's own instance, if it has one alone
    Digest places;        ///< digest of the places of the node's own instances
  };
  /// Everything at and below a node, as one member of a group around it.
  struct Content {
    bool empty = true;
    Group::Member member;
    DMat4 parent_from_member{1};
  };
  struct Finding;

  std::vector<Entry> entries_;
};

}  // namespace carousel::scene
