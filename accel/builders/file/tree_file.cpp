#include "accel/builders/file/tree_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include "core/system/error.h"
#include "core/system/input_file.h"
#include "core/text/edit_distance.h"
#include "core/text/line_reader.h"

namespace carousel::accel {

namespace {

constexpr std::size_t kLongestLine = 4096;
constexpr std::string_view kHeader = "carousel_trees 1";
// As many nodes as a NodeRef can name. Primitives, children and lines have numbers of 32 bits.
constexpr std::uint32_t kMostNodes = 1u << 30, kMostOthers = 0xffffffffu;

class TreeReader {
 public:
  TreeReader(std::istream& in, std::string name) : in_(in, kLongestLine) { file_.name = std::move(name); }

  TreeFile run() {
    if (!next() || line_text() != kHeader) fail(fmt::format("expected the first line '{}'{}", kHeader, found()));
    while (next()) take_line();
    if (in_.too_long()) fail(fmt::format("a line has more than {} bytes", kLongestLine));
    if (file_.trees.empty()) fail("has no tree; expected 'mesh NUMBER PRIMITIVES'");
    finish_node();
    return std::move(file_);
  }

 private:
  /// Goes to the next line with a word on it.
  bool next() {
    while (in_.next()) {
      require_room(line_, kMostOthers, "lines");
      ++line_;
      if (in_.too_long()) return false;
      rest_ = std::string_view(in_.line()).substr(0, in_.line().find('#'));
      trim();
      if (!rest_.empty()) return true;
    }
    return false;
  }
  void trim() {
    const auto blank = [](char c) { return c == ' ' || c == '\t'; };
    while (!rest_.empty() && blank(rest_.front())) rest_.remove_prefix(1);
    while (!rest_.empty() && blank(rest_.back())) rest_.remove_suffix(1);
  }
  std::string_view line_text() const { return rest_; }
  std::string found() const { return rest_.empty() ? "" : fmt::format(", found '{}'", rest_.substr(0, 60)); }

  std::string_view word() {
    const std::string_view out = rest_.substr(0, rest_.find_first_of(" \t"));
    rest_.remove_prefix(out.size());
    trim();
    return out;
  }
  template <class T>
  T number(std::string_view what) {
    const std::string_view text = word();
    T value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size())
      fail(fmt::format("expected {}, found '{}'", what, text));
    return value;
  }
  std::uint32_t count(std::string_view what) { return number<std::uint32_t>(what); }
  void end_line() {
    if (!rest_.empty()) fail(fmt::format("expected the end of the line{}", found()));
  }

  void take_line() {
    const std::string_view kind = word();
    if (kind == "mesh" || kind == "instance" || kind == "merged") return begin_tree(kind);
    if (kind == "node") return begin_node();
    if (kind == "inner" || kind == "leaf") return add_child(kind == "leaf");
    const auto near = nearest_name(kind, {"mesh", "instance", "merged", "node", "inner", "leaf"});
    fail(fmt::format("expected mesh, instance, merged, node, inner or leaf, found '{}'{}", kind,
                     near ? fmt::format("; did you mean '{}'?", *near) : ""));
  }

  /// There are `count` of `what` so far, and one more comes.
  void require_room(std::size_t count, std::uint32_t most, std::string_view what) const {
    if (count >= most) fail(fmt::format("expected at most {} {}, found more", most, what));
  }

  void begin_tree(std::string_view kind) {
    if (!file_.trees.empty()) finish_node();
    FileTree tree;
    using enum TreeSource::Kind;
    tree.source.kind = kind == "mesh" ? kMesh : kind == "instance" ? kInstance : kMerged;
    if (tree.source.kind != kMerged) tree.source.index = count(fmt::format("the number of the {}", kind));
    tree.primitive_count = count("the number of its primitives");
    tree.line = line_;
    end_line();
    for (const FileTree& other : file_.trees)
      if (other.source == tree.source)
        fail(fmt::format("expected one tree of {}, found a second; the first is in line {}", tree.source.text(),
                         other.line));
    file_.trees.push_back(std::move(tree));
  }

  void begin_node() {
    FileTree& tree = current();
    if (!tree.nodes.empty()) finish_node();
    const std::uint32_t index = count("the number of the node");
    end_line();
    require_room(tree.nodes.size(), kMostNodes, "nodes of a tree");
    if (index != tree.nodes.size())
      fail(fmt::format("expected node {}, since nodes stand in the order of their numbers, found node {}",
                       tree.nodes.size(), index));
    tree.nodes.push_back({static_cast<std::uint32_t>(tree.children.size()), 0, line_});
  }

  void add_child(bool leaf) {
    FileTree& tree = current();
    if (tree.nodes.empty()) fail("expected 'node 0' before its children");
    FileTree::Child child;
    child.line = line_;
    if (!leaf && (child.node = count("the number of a node")) >= kMostNodes)
      fail(fmt::format("expected a node below {}, found {}", kMostNodes, child.node));
    for (Vec3* corner : {&child.box.lo, &child.box.hi})
      for (int axis = 0; axis < 3; ++axis) (*corner)[axis] = number<float>("a coordinate of the box");
    for (int axis = 0; axis < 3; ++axis)
      if (!std::isfinite(child.box.lo[axis]) || !std::isfinite(child.box.hi[axis]) ||
          child.box.lo[axis] > child.box.hi[axis])
        fail(fmt::format("expected a box of six finite numbers, least x y z and then greatest, found {} to {} along {}",
                         child.box.lo[axis], child.box.hi[axis], "xyz"[axis]));
    child.first = static_cast<std::uint32_t>(tree.primitives.size());
    while (leaf && !rest_.empty()) {
      require_room(tree.primitives.size(), kMostOthers, "primitives in the leaves of a tree");
      tree.primitives.push_back(count("the number of a primitive"));
    }
    child.count = static_cast<std::uint32_t>(tree.primitives.size()) - child.first;
    if (leaf && child.count == 0) fail("expected the numbers of a leaf's primitives behind its box");
    end_line();
    require_room(tree.children.size(), kMostOthers, "children of the nodes of a tree");
    tree.children.push_back(child);
    ++tree.nodes.back().count;
  }

  void finish_node() {
    const FileTree& tree = file_.trees.back();
    if (tree.nodes.empty()) fail_at(tree.line, fmt::format("{} has no nodes; expected 'node 0'", tree.source.text()));
    if (tree.nodes.back().count == 0)
      fail_at(tree.nodes.back().line, fmt::format("node {} has no children", tree.nodes.size() - 1));
  }

  FileTree& current() {
    if (file_.trees.empty()) fail("expected 'mesh NUMBER PRIMITIVES' before its nodes");
    return file_.trees.back();
  }
  [[noreturn]] void fail(const std::string& message) const { fail_at(line_, message); }
  [[noreturn]] void fail_at(std::uint32_t line, const std::string& message) const {
    throw SceneError(fmt::format("{}:{}", file_.name, std::max(line, 1u)), "", message);
  }

  LineReader in_;
  TreeFile file_;
  std::uint32_t line_ = 0;
  std::string_view rest_;
};

}  // namespace

std::string TreeSource::text() const {
  switch (kind) {
    case Kind::kMesh:
      return fmt::format("mesh {}", index);
    case Kind::kInstance:
      return fmt::format("instance {}", index);
    case Kind::kMerged:
      break;
  }
  return "merged";
}

const FileTree& TreeFile::of(const TreeSource& source) const {
  for (const FileTree& tree : trees)
    if (tree.source == source) return tree;
  throw SceneError(name, "", fmt::format("has no tree of {}, which stands in the scene", source.text()));
}

TreeFile read_trees(std::istream& in, const std::string& name) {
  TreeFile out = TreeReader(in, name).run();
  if (in.bad()) throw FileError("cannot read " + name);
  return out;
}

TreeFile read_trees(const std::filesystem::path& path) {
  std::error_code ignored;
  InputFile in(path);
  if (!in || std::filesystem::is_directory(path, ignored)) throw FileError("cannot read " + path.string());
  return read_trees(in, path.string());
}

}  // namespace carousel::accel
