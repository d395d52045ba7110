#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/system/memory_budget.h"

namespace carousel::scene {

using Json = nlohmann::json;

/// `path` extended by a key or an index, as JSON pointers are written (RFC 6901).
std::string json_path(const std::string& path, std::string_view key);
std::string json_path(const std::string& path, std::size_t index);

/// What of a file's skins, morph targets and animations is shown. The base pose, which is shown without it, uses none.
struct Posing {
  bool on = false;
  std::vector<bool> animations;  ///< those that may be played
};

/// The parts of a glTF file, none of them checked yet.
struct GltfDocument {
  std::string file;  ///< its name in messages
  Json json;         ///< an object; `asset.version` is 2.x
  bool is_glb = false;
  Posing posing;
  std::size_t morph_targets = 0;            ///< of all meshes
  std::span<const std::byte> binary_chunk;  ///< the binary chunk of a .glb; refers to the bytes that were parsed

  [[noreturn]] void fail(const std::string& path, const std::string& message) const;
};

/// True if the list, "extensionsUsed" or "extensionsRequired", names the extension.
bool lists_extension(const GltfDocument& document, const char* list, const char* extension);

/// Splits a .glb into its chunks or takes the bytes as JSON text, and parses that. Nesting is bounded before
/// any parser runs, because tinygltf recurses on what it reads. `bytes` must outlive the result. Throws
/// SceneError for a broken container, broken JSON, nesting beyond 128 levels or another glTF version.
GltfDocument parse_document(std::span<const std::byte> bytes, const std::string& file);

/// The memory of an import, and the places in the file that ask for it. All that a file announces is asked for here
/// before it is allocated: a few bytes may announce zeros by the billion.
class ImportBudget {
 public:
  /// Keeps references to both.
  ImportBudget(const GltfDocument& document, MemoryBudget& memory) : document_(document), memory_(memory) {}

  /// Takes bytes for the rest of the import. Throws a SceneError at `path` that begins with `what` ("the image") if
  /// fewer are left.
  void take(std::uint64_t bytes, const std::string& path, const std::string& what) const;
  /// Takes bytes for as long as the result lives. Throws as take() does.
  [[nodiscard]] MemoryBudget::Loan lend(std::uint64_t bytes, const std::string& path, const std::string& what) const;
  MemoryBudget& memory() const { return memory_; }

 private:
  const GltfDocument& document_;
  MemoryBudget& memory_;
};

}  // namespace carousel::scene
