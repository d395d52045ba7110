#include "core/config/tree/tree_builder.h"

#include <algorithm>
#include <utility>

namespace carousel::config {

namespace {

std::size_t count_nodes(const Node& node) {
  std::size_t count = 1;
  for (const Node& item : node.items) count += count_nodes(item);
  for (const Member& member : node.members) count += count_nodes(member.value);
  return count;
}

std::size_t depth_of(const Node& node) {
  std::size_t depth = 0;
  for (const Node& item : node.items) depth = std::max(depth, depth_of(item));
  for (const Member& member : node.members) depth = std::max(depth, depth_of(member.value));
  return depth + (node.kind == Node::Kind::kSeq || node.kind == Node::Kind::kMap ? 1 : 0);
}

/// Length of the UTF-8 character at `at`, or 0 when it is none (overlong, a surrogate, cut short).
std::size_t utf8_length(std::string_view text, std::size_t at) {
  const auto byte = [&](std::size_t i) { return at + i < text.size() ? static_cast<unsigned char>(text[at + i]) : 0u; };
  const auto follows = [&](std::size_t i) { return (byte(i) & 0xc0) == 0x80; };
  const unsigned b0 = byte(0), b1 = byte(1);
  if (b0 < 0x80) return 1;
  if (b0 >= 0xc2 && b0 <= 0xdf) return follows(1) ? 2 : 0;
  if (b0 >= 0xe0 && b0 <= 0xef) {
    if ((b0 == 0xe0 && b1 < 0xa0) || (b0 == 0xed && b1 > 0x9f)) return 0;
    return follows(1) && follows(2) ? 3 : 0;
  }
  if (b0 >= 0xf0 && b0 <= 0xf4) {
    if ((b0 == 0xf0 && b1 < 0x90) || (b0 == 0xf4 && b1 > 0x8f)) return 0;
    return follows(1) && follows(2) && follows(3) ? 4 : 0;
  }
  return 0;
}

}  // namespace

void TreeBuilder::fail(const SourcePosition& position, std::string message) const {
  std::vector<ConfigIssue> issues = issues_;
  issues.push_back({position, "", std::move(message)});
  throw ConfigError(std::move(issues));
}

void TreeBuilder::begin(Node::Kind kind, SourcePosition position) {
  if (open_.size() >= kMaxDepth) fail(position, "nested more than " + std::to_string(kMaxDepth) + " deep");
  Open open;
  open.node.kind = kind;
  open.node.position = std::move(position);
  open_.push_back(std::move(open));
}

const Node& TreeBuilder::end() {
  count(1, open_.back().node.position);  // its entries were counted when they came
  Node node = std::move(open_.back().node);
  open_.pop_back();
  return attach(std::move(node));
}

bool TreeBuilder::wants_key() const {
  return !open_.empty() && open_.back().node.kind == Node::Kind::kMap && !open_.back().have_key;
}

void TreeBuilder::key(std::string text, SourcePosition position) {
  Open& map = open_.back();
  const auto same = std::find_if(map.node.members.begin(), map.node.members.end(),
                                 [&](const Member& member) { return member.key == text; });
  map.duplicate = same != map.node.members.end();
  if (map.duplicate) {
    const SourcePosition& first = same->key_position;
    std::string message = "duplicate key";
    if (first.line > 0)
      message += "; first given at line " + std::to_string(first.line) + ", column " + std::to_string(first.column);
    issues_.push_back({position, path_of(text), std::move(message)});
  }
  map.have_key = true;
  map.key = std::move(text);
  map.key_position = std::move(position);
}

const Node& TreeBuilder::value(Node node) {
  if (open_.size() + depth_of(node) > kMaxDepth)
    fail(node.position, "nested more than " + std::to_string(kMaxDepth) + " deep");
  count(count_nodes(node), node.position);
  return attach(std::move(node));
}

void TreeBuilder::count(std::size_t nodes, const SourcePosition& position) {
  nodes_ += nodes;
  if (nodes_ > kMaxNodes) fail(position, "more than " + std::to_string(kMaxNodes) + " values, aliases expanded");
}

std::string TreeBuilder::path_of(std::string_view key) const {
  std::string path;
  for (const Open& open : open_) {
    if (&open == &open_.back()) break;
    path += (open.node.kind == Node::Kind::kSeq ? std::to_string(open.node.items.size()) : open.key) + ".";
  }
  return path + std::string(key);
}

const Node& TreeBuilder::attach(Node node) {
  if (open_.empty()) {
    root_ = std::move(node);
    return root_;
  }
  Open& parent = open_.back();
  if (parent.node.kind == Node::Kind::kSeq) {
    parent.node.items.push_back(std::move(node));
    return parent.node.items.back();
  }
  parent.have_key = false;
  // A parser notices that a value is missing only at what comes next.
  if (node.kind == Node::Kind::kNull) node.position = parent.key_position;
  if (parent.duplicate) {
    dropped_ = std::move(node);
    return dropped_;
  }
  parent.node.members.push_back({std::move(parent.key), std::move(parent.key_position), std::move(node)});
  return parent.node.members.back().value;
}

void check_text(std::string_view text, const std::string& name) {
  if (text.size() > kMaxBytes)
    throw ConfigError({{{name, 0, 0}, "", "larger than " + std::to_string(kMaxBytes) + " bytes"}});
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t length = utf8_length(text, at);
    if (length == 0) throw ConfigError({{position_at(text, at, name), "", "not UTF-8 text"}});
    at += length;
  }
}

SourcePosition position_at(std::string_view text, std::size_t offset, const std::string& name) {
  const std::string_view before = text.substr(0, std::min(offset, text.size()));
  const std::size_t newline = before.rfind('\n');
  return {name, 1 + static_cast<int>(std::count(before.begin(), before.end(), '\n')),
          static_cast<int>(before.size() - (newline == before.npos ? 0 : newline + 1)) + 1};
}

}  // namespace carousel::config
