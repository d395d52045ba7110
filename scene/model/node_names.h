#pragma once

#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "scene/model/scene.h"

namespace carousel::scene {

/// Collects the names of a file's nodes while they are walked depth-first, so that the instances of a subtree follow
/// one another.
class NodeNames {
 public:
  /// The next node, `depth` below the roots; its instances and those below it follow `first_instance` others. A name
  /// without control characters.
  void add(std::string name, std::size_t depth, std::size_t first_instance) {
    visited_.push_back({std::move(name), depth, first_instance});
  }

  /// Writes the nodes that have a name and show something into the scene, all of whose instances are there.
  void write(Scene& scene) && {
    std::vector<std::size_t> ends(visited_.size(), scene.instances.size()), open;
    for (std::size_t i = 0; i < visited_.size(); ++i) {
      for (; !open.empty() && visited_[open.back()].depth >= visited_[i].depth; open.pop_back())
        ends[open.back()] = visited_[i].first_instance;
      open.push_back(i);
    }
    for (std::size_t i = 0; i < visited_.size(); ++i) {
      const std::size_t first = visited_[i].first_instance;
      if (!visited_[i].name.empty() && ends[i] > first)
        scene.nodes.push_back({std::move(visited_[i].name), first, ends[i] - first});
    }
  }

 private:
  struct Visited {
    std::string name;
    std::size_t depth, first_instance;
  };
  std::vector<Visited> visited_;
};

}  // namespace carousel::scene
