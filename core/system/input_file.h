#pragma once

#include <filesystem>
#include <istream>
#include <memory>

namespace carousel {

/// A file to read that may be a pipe or a terminal. It is read as std::ifstream is, but a reader that waits can be
/// interrupted (stop_request.h), and an error while it reads is a FileError: no part of a file is taken for the whole.
class InputFile : public std::istream {
 public:
  /// Without success the stream has failed (operator!), and errno says why.
  explicit InputFile(const std::filesystem::path& file);
  ~InputFile() override;

 private:
  class Buffer;
  std::unique_ptr<Buffer> buffer_;
};

}  // namespace carousel
