#include "scene/model/node_bounds.h"

#include <cstddef>

namespace carousel::scene {

std::vector<Aabb> node_bounds(const Scene& scene) {
  // From the last node to the first, so that children come before their parents. A node takes the boxes of the nodes
  // below it, and those of the instances between them; `open` holds what no parent has taken, the first of it last.
  std::vector<Aabb> out(scene.nodes.size());
  std::vector<std::size_t> open;
  for (std::size_t i = scene.nodes.size(); i-- > 0;) {
    const NamedNode& node = scene.nodes[i];
    const std::size_t end = node.first_instance + node.instances;
    std::size_t at = node.first_instance;
    const auto take_until = [&](std::size_t stop) {
      for (; at < stop; ++at) out[i].extend(scene.bounds(scene.instances[at]));
    };
    for (; !open.empty() && scene.nodes[open.back()].first_instance < end; open.pop_back()) {
      const NamedNode& below = scene.nodes[open.back()];
      take_until(below.first_instance);
      out[i].extend(out[open.back()]);
      at = below.first_instance + below.instances;
    }
    take_until(end);
    open.push_back(i);
  }
  return out;
}

}  // namespace carousel::scene
