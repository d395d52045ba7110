#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "core/config/tree/tree.h"

namespace carousel {

/// Where the values of a configuration stand in the user's files, by key path.
class KeyPositions {
 public:
  KeyPositions() = default;
  KeyPositions(const config::Node& root, std::string file);

  /// The position of the value at `path`, or else of the nearest enclosing section that is given, or else of the file.
  SourcePosition find(std::string_view path) const;
  /// The keys that are given a value, in alphabetical order. A list is one value, that of its key.
  std::vector<std::string> given() const;
  const std::string& file() const { return file_; }

 private:
  void collect(const config::Node& node, const std::string& path);

  std::string file_;
  std::map<std::string, SourcePosition, std::less<>> positions_;
};

}  // namespace carousel
