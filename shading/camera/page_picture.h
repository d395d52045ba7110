#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace carousel::shading {

/// A picture as a page holds it.
struct PagePicture {
  std::string mime_type, bytes;
};

/// The picture of a PNG file: the file itself, or, if it has more than a megabyte, a lossy WebP of it, at most 1,600
/// pixels wide. Nothing if the file is not there or cannot be read.
std::optional<PagePicture> page_picture(const std::filesystem::path& png);

}  // namespace carousel::shading
