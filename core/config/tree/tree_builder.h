#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/config/tree/tree.h"

namespace carousel::config {

/// Grows a tree from the events of a parser; what both front ends share: limits and duplicate keys.
class TreeBuilder {
 public:
  TreeBuilder(std::string name, std::vector<ConfigIssue>& issues) : name_(std::move(name)), issues_(issues) {}

  void begin(Node::Kind kind, SourcePosition position);  ///< kSeq or kMap
  /// Ends the innermost list or map and returns it; valid until the next call.
  const Node& end();
  /// The next key of the innermost map.
  void key(std::string text, SourcePosition position);
  /// A finished value: a scalar, or a copy that an alias stands for.
  const Node& value(Node node);

  /// True if the next event has to be a key.
  bool wants_key() const;
  Node take_root() { return std::move(root_); }
  [[noreturn]] void fail(const SourcePosition& position, std::string message) const;
  SourcePosition at(int line, int column) const { return {name_, line, column}; }

 private:
  struct Open {
    Node node;
    bool have_key = false;
    bool duplicate = false;  ///< the value to come belongs to a key seen before, and is dropped
    std::string key;
    SourcePosition key_position;
  };
  const Node& attach(Node node);
  void count(std::size_t nodes, const SourcePosition& position);
  std::string path_of(std::string_view key) const;

  std::string name_;
  std::vector<ConfigIssue>& issues_;
  std::vector<Open> open_;
  std::size_t nodes_ = 0;
  Node root_, dropped_;
};

/// Throws a ConfigError unless `text` is UTF-8 and within kMaxBytes.
void check_text(std::string_view text, const std::string& name);

/// Line and column (from 1, in bytes) of an offset.
SourcePosition position_at(std::string_view text, std::size_t offset, const std::string& name);

}  // namespace carousel::config
