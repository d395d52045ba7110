#include "core/config/tree/positions.h"

namespace carousel {

KeyPositions::KeyPositions(const config::Node& root, std::string file) : file_(std::move(file)) {
  collect(root, "");
}

void KeyPositions::collect(const config::Node& node, const std::string& path) {
  if (!path.empty()) positions_.emplace(path, node.position);
  const std::string prefix = path.empty() ? "" : path + ".";
  for (std::size_t i = 0; i < node.items.size(); ++i) collect(node.items[i], prefix + std::to_string(i));
  for (const config::Member& member : node.members) collect(member.value, prefix + member.key);
}

SourcePosition KeyPositions::find(std::string_view path) const {
  while (!path.empty()) {
    if (const auto found = positions_.find(path); found != positions_.end()) return found->second;
    const std::size_t dot = path.rfind('.');
    path = path.substr(0, dot == path.npos ? 0 : dot);
  }
  return {file_, 0, 0};
}

}  // namespace carousel
