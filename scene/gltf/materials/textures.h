#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "scene/gltf/document/document.h"
#include "scene/model/scene.h"
#include "scene/model/warnings.h"

namespace carousel::scene {

/// Turns the texture slots of materials into scene::TextureUse. Unused textures and images are left out.
class TextureReader {
 public:
  /// Fills `scene.textures`. The document has passed check_schema.
  TextureReader(const GltfDocument& document, Scene& scene) : document_(document), scene_(scene) {}

  /// The texture in slot `slot` of `owner` (a material, or one of its extension objects at JSON path `path`), with
  /// KHR_texture_transform and either of the first two sets of texture coordinates. Empty if the slot is empty, or if
  /// its texture cannot be read, which is counted. Throws SceneError for a texture that is Basis Universal only.
  std::optional<TextureUse> use(const Json& owner, const char* slot, const std::string& path);

  /// Emits one warning that covers all dropped uses.
  void warn_of_dropped_uses(const WarningSink& warn) const;
  /// Image i of the scene is this one of the file.
  const std::vector<std::size_t>& images() const { return images_; }

 private:
  std::optional<std::size_t> image_of(std::size_t texture);
  TextureId texture(std::size_t index, std::size_t image);

  const GltfDocument& document_;
  Scene& scene_;
  std::map<std::size_t, std::uint32_t> textures_, image_ids_;
  std::vector<std::size_t> images_;
  std::map<std::string, int> dropped_;
};

}  // namespace carousel::scene
