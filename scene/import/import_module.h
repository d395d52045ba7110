#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "scene/model/image_choice.h"
#include "scene/model/scene.h"
#include "scene/model/warnings.h"

namespace carousel::scene {

/// What the program does for a module that reads scenes, so that the module needs no library of the program.
struct ImportServices {
  WarningSink warn;    ///< may be empty
  ImageChoice images;  ///< which images are worth decoding; may be empty: all that materials name
  /// Asked before each allocation whose size the file announces. Throws std::length_error with a reason if the limit of
  /// memory does not allow so many bytes; the module lets it pass.
  std::function<void(std::uint64_t bytes)> take;
  /// The pixels of an encoded picture, in any format that the program or its modules read; it takes their memory from
  /// the limit. Throws std::runtime_error or std::length_error with a reason, without a place.
  std::function<Image(std::span<const unsigned char> encoded, const std::string& name)> decode;
};

/// The interface of a module that reads scene files other than glTF (core/module/module.h).
struct ImportModule {
  static constexpr const char* kModule = "scenes";

  /// Reads a scene file. Throws a SceneError with the file, the place in it and the reason, and lets pass what the
  /// services throw. A camera, a light or a sky that the file lacks are added by the caller.
  Scene (*load)(const std::filesystem::path& file, const ImportServices& services) = nullptr;
  /// Endings of the files that load() reads, in lower case and without the point, sorted.
  std::vector<std::string> (*extensions)() = nullptr;
};

}  // namespace carousel::scene
