#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "scene/images/picture_module.h"

namespace carousel::pictures {

/// A file in memory that libraries open by its name.
class MemoryFile {
 public:
  /// Throws std::runtime_error.
  explicit MemoryFile(std::string_view bytes = {});
  ~MemoryFile();
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  std::string name() const;
  std::string bytes() const;

 private:
  int descriptor_;
};

/// ModuleInfo::answer: pixels, then a PictureAnswer. Throws std::runtime_error with a reason.
std::string read_picture(std::string_view question);

/// PictureModule::write.
std::string write_picture(const std::string& ending, std::uint32_t width, std::uint32_t height,
                          std::span<const float> linear, std::span<const std::uint8_t> display);
/// PictureModule::writes.
bool writes_picture(const std::string& ending);

}  // namespace carousel::pictures
