#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace carousel::config {

/// The names of a graph's nodes, and what patterns of names stand for: `x` a node of that name; of a group, `r[*]` all
/// nodes, `r[3]` one, `r[0..3]` a few, and `r[3..0]` these backwards; several of these with commas between them.
class NodeNames {
 public:
  /// `size`: nodes of the group, of which `first` is the number of r[0]; absent: one node. False if the name is taken.
  bool add(const std::string& name, std::uint32_t first, std::optional<std::int64_t> size);
  /// The numbers of the nodes. Empty if it stands for none, and `error` says why.
  std::vector<std::uint32_t> find(std::string_view pattern, std::string& error) const;
  /// A letter or underscore, and then letters, digits and underscores.
  static bool is_name(std::string_view text);

 private:
  struct Group {
    std::uint32_t first = 0;
    std::optional<std::int64_t> size;
  };
  std::vector<std::uint32_t> find_one(std::string_view pattern, std::string& error) const;
  std::string unknown(std::string_view name) const;

  std::map<std::string, Group, std::less<>> groups_;
};

}  // namespace carousel::config
