#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>

#include <assimp/material.h>
#include <assimp/scene.h>

#include "modules/scenes/source_files.h"
#include "scene/import/imported.h"

namespace carousel::scenes {

/// Turns Assimp's materials into the program's, with their images and textures.
class MaterialMap {
 public:
  MaterialMap(const aiScene& from, const SourceFiles& files, scene::Imported& to)
      : from_(from), files_(files), to_(to) {}

  /// Appends all materials, in order. What has no counterpart is named in warnings, each kind once.
  void map_all();

 private:
  /// An image by its name in the file; none where it is missing, which is told.
  std::optional<std::uint32_t> image_of(const std::string& name);
  std::optional<scene::TextureUse> texture(const aiMaterial& material, aiTextureType type);
  scene::Material map(const aiMaterial& material);
  void map_colors(const aiMaterial& from, scene::Material& to);
  void map_textures(const aiMaterial& from, scene::Material& to);
  void unlike(const std::string& part) { unlike_.insert(part); }

  const aiScene& from_;
  const SourceFiles& files_;
  scene::Imported& to_;
  std::map<std::string, std::optional<std::uint32_t>> images_;
  std::set<std::string> unlike_;  ///< parts without a counterpart
};

}  // namespace carousel::scenes
