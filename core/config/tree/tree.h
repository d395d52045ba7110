#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "core/system/error.h"

namespace carousel::config {

struct Member;

/// A value of a configuration file and where it stands. Numbers keep their text (decimal, "inf", "-inf" or
/// "nan"), so that each reader rounds once, to the type it needs.
struct Node {
  enum class Kind { kNull, kBool, kInt, kFloat, kString, kSeq, kMap } kind = Kind::kNull;
  std::string text;             ///< the text of a scalar
  std::vector<Node> items;      ///< the items of a kSeq
  std::vector<Member> members;  ///< the members of a kMap, in file order; keys are unique
  SourcePosition position;

  const Node* find(std::string_view key) const;
  /// The text that stands behind "found" in a message: "'text'", "12", "a list" ...
  std::string found() const;
};

struct Member {
  std::string key;
  SourcePosition key_position;
  Node value;
};

inline constexpr std::size_t kMaxBytes = 1 << 20;  ///< most bytes in a file
inline constexpr std::size_t kMaxDepth = 32;       ///< most levels of lists and maps within one another
inline constexpr std::size_t kMaxNodes = 1 << 15;  ///< most nodes in a tree, aliases expanded

/// Both front ends: duplicate keys are appended to `issues` and the first value is kept; what cannot be read
/// at all (syntax, a second document, limits above, text that is not UTF-8) is thrown as a ConfigError.
Node parse_yaml(std::string_view text, const std::string& name, std::vector<ConfigIssue>& issues);
Node parse_json(std::string_view text, const std::string& name, std::vector<ConfigIssue>& issues);

/// JSON if `name` ends in .json, or if the text starts with '{' and is JSON; otherwise YAML.
Node parse_tree(std::string_view text, const std::string& name, std::vector<ConfigIssue>& issues);

/// Applies one `key.path=value` (the value is YAML) to the tree, making maps and list entries that are
/// missing. The position of what it sets is "--set key.path=value".
void apply_set(Node& root, std::string_view assignment, std::vector<ConfigIssue>& issues);

}  // namespace carousel::config
