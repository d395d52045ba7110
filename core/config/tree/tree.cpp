#include "core/config/tree/tree.h"

#include <algorithm>
#include <charconv>

#include <nlohmann/json.hpp>

#include "core/config/tree/tree_builder.h"

namespace carousel::config {

const Node* Node::find(std::string_view key) const {
  for (const Member& member : members)
    if (member.key == key) return &member.value;
  return nullptr;
}

std::string Node::found() const {
  constexpr std::size_t kLongest = 60;
  std::string shown = text;
  if (shown.size() > kLongest) {
    std::size_t cut = kLongest;
    while (cut > 0 && (static_cast<unsigned char>(shown[cut]) & 0xc0) == 0x80) --cut;  // not inside a character
    shown = shown.substr(0, cut) + "...";
  }
  switch (kind) {
    case Kind::kNull:
      return "nothing";
    case Kind::kSeq:
      return "a list";
    case Kind::kMap:
      return "a map";
    case Kind::kString:
      return "'" + shown + "'";
    default:
      return shown;
  }
}

Node parse_tree(std::string_view text, const std::string& name, std::vector<ConfigIssue>& issues) {
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  if (text.substr(0, kByteOrderMark.size()) == kByteOrderMark) text.remove_prefix(kByteOrderMark.size());
  const bool json_name = name.size() >= 5 && name.compare(name.size() - 5, 5, ".json") == 0;
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  const bool braced = first != std::string_view::npos && text[first] == '{' && text.size() <= kMaxBytes;
  // YAML's flow maps start with a brace too, hence the trial.
  if (json_name || (braced && nlohmann::json::accept(text))) return parse_json(text, name, issues);
  return parse_yaml(text, name, issues);
}

namespace {

/// The names between the dots. Keys of `vary` are key paths themselves: what follows it is one name.
std::vector<std::string_view> split_path(std::string_view path) {
  std::vector<std::string_view> parts;
  for (std::size_t begin = 0; begin <= path.size();) {
    const bool whole = parts.size() == 1 && parts[0] == "vary";
    const std::size_t end = whole ? path.size() : std::min(path.find('.', begin), path.size());
    parts.push_back(path.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

bool is_index(std::string_view part) {
  return !part.empty() && part.size() <= 4 && part.find_first_not_of("0123456789") == std::string_view::npos;
}

/// Makes `node` a container that can hold `part`; a bare number there was short for {units: number}.
void make_container(Node& node, std::string_view part, const SourcePosition& position) {
  if (node.kind == Node::Kind::kMap || node.kind == Node::Kind::kSeq) return;
  Node made;
  made.position = position;
  made.kind = node.kind == Node::Kind::kNull && is_index(part) ? Node::Kind::kSeq : Node::Kind::kMap;
  if (node.kind == Node::Kind::kInt) made.members.push_back({"units", node.position, node});
  node = std::move(made);
}

/// The entry `part` of `node`, made if it is missing; null when a list has no such entry.
Node* step_into(Node& node, std::string_view part, const SourcePosition& position) {
  make_container(node, part, position);
  if (node.kind == Node::Kind::kMap) {
    for (Member& member : node.members)
      if (member.key == part) return &member.value;
    node.members.push_back({std::string(part), position, Node{}});
    node.members.back().value.position = position;
    return &node.members.back().value;
  }
  if (!is_index(part)) return nullptr;
  std::size_t index = 0;
  std::from_chars(part.data(), part.data() + part.size(), index);
  if (index > node.items.size()) return nullptr;
  if (index == node.items.size()) {
    node.items.emplace_back();
    node.items.back().position = position;
  }
  return &node.items[index];
}

void move_to(Node& node, const SourcePosition& position) {
  node.position = position;
  for (Node& item : node.items) move_to(item, position);
  for (Member& member : node.members) {
    member.key_position = position;
    move_to(member.value, position);
  }
}

}  // namespace

void apply_set(Node& root, std::string_view assignment, std::vector<ConfigIssue>& issues) {
  SourcePosition position;
  position.file = "--set " + std::string(assignment);
  const std::size_t equals = assignment.find('=');
  if (equals == std::string_view::npos || equals == 0) {
    issues.push_back({position, "", "expected key.path=value"});
    return;
  }
  const std::string_view path = assignment.substr(0, equals);
  const std::vector<std::string_view> parts = split_path(path);
  if (parts.size() > kMaxDepth / 2 || std::find(parts.begin(), parts.end(), "") != parts.end()) {
    issues.push_back({position, std::string(path), "expected key.path=value, with names between the dots"});
    return;
  }
  Node value;
  try {
    std::vector<ConfigIssue> found;
    value = parse_yaml(assignment.substr(equals + 1), position.file, found);
    for (ConfigIssue& issue : found) issues.push_back({position, std::string(path), std::move(issue.message)});
  } catch (const ConfigError& error) {
    for (const ConfigIssue& issue : error.issues()) issues.push_back({position, std::string(path), issue.message});
    return;
  }
  move_to(value, position);

  Node* node = &root;
  for (const std::string_view part : parts) {
    Node* next = step_into(*node, part, position);
    if (!next) {
      const std::string size = std::to_string(node->items.size());
      issues.push_back({position, std::string(path),
                        "the list has " + size + " entries; expected an index from 0 to " + size + ", found '" +
                            std::string(part) + "'"});
      return;
    }
    node = next;
  }
  *node = std::move(value);
}

}  // namespace carousel::config
