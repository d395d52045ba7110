#include "core/config/tree/positions.h"

#include <iterator>

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

std::vector<std::string> KeyPositions::given() const {
  std::vector<std::string> out;
  for (auto at = positions_.begin(); at != positions_.end(); ++at) {
    std::string key = at->first;
    for (std::size_t dot = key.find('.'); dot != key.npos; dot = key.find('.', dot + 1))
      if (dot + 1 < key.size() && key[dot + 1] >= '0' && key[dot + 1] <= '9') key.resize(dot);  // an entry of a list
    const auto next = std::next(at);
    const bool below = next != positions_.end() && next->first.starts_with(at->first + ".");
    const bool section =
        below && !(next->first[at->first.size() + 1] >= '0' && next->first[at->first.size() + 1] <= '9');
    if (!section && (out.empty() || out.back() != key)) out.push_back(std::move(key));
  }
  return out;
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
