#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace carousel::scene {

/// The interface of the module that reads and writes pictures of formats that the program itself has no code for. What
/// is written comes from the program, and is written within it; what is read comes from strangers, and is read in a
/// process of its own: ModuleInfo::answer of the module takes a PictureQuestion and gives pixels.
struct PictureModule {
  static constexpr const char* kModule = "pictures";

  /// The file of a picture, as bytes. `ending` is the name of a PictureFile; `linear` and `display` are row-major from
  /// the top left, three channels a pixel: linear light, and sRGB for display. Formats that hold floats get the first.
  /// Throws std::runtime_error with a reason.
  std::string (*write)(const std::string& ending, std::uint32_t width, std::uint32_t height,
                       std::span<const float> linear, std::span<const std::uint8_t> display) = nullptr;
  /// True if the library was built to write this ending.
  bool (*writes)(const std::string& ending) = nullptr;
};

/// Stands before the question; the name of the format and that of the file follow it, then the bytes of the file.
struct PictureQuestion {
  std::uint64_t memory = 0;  ///< bytes that the reader may take for pixels
  std::uint32_t format_bytes = 0, name_bytes = 0;
  bool color = false;  ///< the picture is used as colours: linear light becomes sRGB, as all colours of textures are
};

/// Stands behind the pixels, four bytes each as in Image::rgba. Without pixels the reader would need more memory.
struct PictureAnswer {
  std::uint32_t width = 0, height = 0;
  std::uint64_t work = 0;  ///< bytes that the reader needs beside the pixels
};

}  // namespace carousel::scene
