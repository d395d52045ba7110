#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "scene/gltf/document/document.h"

namespace carousel::scene {

using Bytes = std::vector<unsigned char>;

/// Finds the bytes that buffers and images name. Addresses are data: URIs (base64) or relative paths that
/// stay within the folder of the file or the two above it; nothing is ever fetched.
class GltfResources {
 public:
  /// `folder` is where relative paths start; absent for a scene from memory, which then must embed
  /// everything.
  GltfResources(const GltfDocument& document, const ImportBudget& budget, std::optional<std::filesystem::path> folder)
      : document_(document), budget_(budget), folder_(std::move(folder)) {}

  /// Exactly byteLength bytes, or none for a buffer without data (as compression extensions allow).
  /// Throws SceneError when the data cannot be found, is too short, or exceeds the import's memory.
  std::optional<Bytes> buffer(std::size_t index) const;
  /// The encoded bytes of an image that has a `uri`.
  Bytes image(std::size_t index) const;

 private:
  Bytes read_uri(const std::string& uri, const std::string& path, std::uint64_t most_bytes) const;
  Bytes read_file(const std::string& uri, const std::string& path, std::uint64_t most_bytes) const;

  const GltfDocument& document_;
  const ImportBudget& budget_;
  std::optional<std::filesystem::path> folder_;
};

/// Decodes base64 (RFC 4648; padding may be missing), at most `most_bytes` of it. Empty if a character
/// does not belong there.
std::optional<Bytes> decode_base64(std::string_view text, std::uint64_t most_bytes);

}  // namespace carousel::scene
