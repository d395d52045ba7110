#pragma once

#include <span>
#include <string>
#include <string_view>

namespace carousel::scene {

/// A format that the module pictures reads, by OpenImageIO's name of it.
struct PictureFormat {
  std::string_view name;     ///< "tiff"; empty: none
  std::string_view in_text;  ///< "TIFF"
};

/// The format of a picture by its first bytes, or for those that begin with nothing of their own by the ending of its
/// file. `name` may be empty.
PictureFormat picture_format(std::span<const unsigned char> bytes, std::string_view name);

}  // namespace carousel::scene
