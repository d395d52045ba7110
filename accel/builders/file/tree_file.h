#pragma once

#include <cstdint>
#include <filesystem>
#include <istream>
#include <string>
#include <vector>

#include "core/types/aabb.h"

namespace carousel::accel {

/// This names what a tree is over: a mesh of the scene, by its number; an instance whose transform has no inverse, so
/// that its triangles are stored as they stand in the world; or the meshes that are merged (`bvh.merge`).
struct TreeSource {
  enum class Kind : std::uint8_t { kMesh, kInstance, kMerged } kind = Kind::kMesh;
  std::uint32_t index = 0;

  /// As files write it: "mesh 3", "instance 12", "merged".
  std::string text() const;
  friend bool operator==(const TreeSource&, const TreeSource&) = default;
};

/// A tree as a file has it, not yet checked against a scene. Node 0 is the root.
struct FileTree {
  static constexpr std::uint32_t kLeaf = 0xffffffffu;

  struct Child {
    Aabb box;
    std::uint32_t node = kLeaf;          ///< of an inner child
    std::uint32_t first = 0, count = 0;  ///< of a leaf: in `primitives`
    std::uint32_t line = 0;              ///< of the file
  };
  struct Children {
    std::uint32_t first = 0, count = 0;  ///< in `children`
    std::uint32_t line = 0;
  };

  TreeSource source;
  std::uint32_t primitive_count = 0;  ///< of the source, as the file says
  std::uint32_t line = 0;
  std::vector<Children> nodes;
  std::vector<Child> children;            ///< node by node
  std::vector<std::uint32_t> primitives;  ///< of all leaves
};

/// The trees of a scene's meshes (docs/reference/tree-files.md has the format).
struct TreeFile {
  std::string name;  ///< for errors
  std::vector<FileTree> trees;

  /// Throws SceneError if there is none.
  const FileTree& of(const TreeSource& source) const;
};

/// Reads a file of trees. Throws a SceneError with the line of the first thing that is not as the format says, or that
/// is more than a structure has room for, and FileError when the file cannot be read.
TreeFile read_trees(const std::filesystem::path& path);
TreeFile read_trees(std::istream& in, const std::string& name);

}  // namespace carousel::accel
