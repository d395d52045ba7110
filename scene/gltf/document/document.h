#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

namespace carousel::scene {

using Json = nlohmann::json;

/// `path` extended by a key or an index, as JSON pointers are written (RFC 6901).
std::string json_path(const std::string& path, std::string_view key);
std::string json_path(const std::string& path, std::size_t index);

/// The parts of a glTF file, none of them checked yet.
struct GltfDocument {
  std::string file;  ///< its name in messages
  Json json;         ///< an object; `asset.version` is 2.x
  bool is_glb = false;
  std::span<const std::byte> binary_chunk;  ///< of a .glb; refers to the bytes that were parsed

  [[noreturn]] void fail(const std::string& path, const std::string& message) const;
};

/// True if the list, "extensionsUsed" or "extensionsRequired", names the extension.
bool lists_extension(const GltfDocument& document, const char* list, const char* extension);

/// Splits a .glb into its chunks or takes the bytes as JSON text, and parses that. Nesting is bounded before
/// any parser runs, because tinygltf recurses on what it reads. `bytes` must outlive the result. Throws
/// SceneError for a broken container, broken JSON, nesting beyond 128 levels or another glTF version.
GltfDocument parse_document(std::span<const std::byte> bytes, const std::string& file);

/// The limit of an import's size: vertices, triangles and instances count one each. With accessors without data or
/// shared by many meshes a small file could request any amount of memory; no real file comes near the limit.
class ImportBudget {
 public:
  ImportBudget(const GltfDocument& document, std::uint64_t bytes_read)
      : document_(document), left_((std::uint64_t{1} << 20) + 16 * bytes_read) {}
  /// Throws SceneError at `path` when more than the budget would be spent; call before allocating.
  void spend(std::uint64_t elements, const std::string& path);
  /// Raises the limit for bytes that were unpacked from compressed data.
  void earn(std::uint64_t bytes) { left_ += 16 * bytes; }

 private:
  const GltfDocument& document_;
  std::uint64_t left_;
};

}  // namespace carousel::scene
