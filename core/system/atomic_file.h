#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace carousel {

/// A file that appears under its name completely or not at all: it is written beside its target, flushed to the disk
/// and renamed. A target that is no regular file (a pipe, /dev/stdout) is written to directly. Missing folders are
/// created. Not for several threads at once.
class AtomicFile {
 public:
  /// Throws FileError when the file cannot be made.
  explicit AtomicFile(const std::filesystem::path& target);
  /// Without commit() the target is left as it was and nothing stays beside it.
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// Appends. Throws FileError (disk full, quota).
  void write(std::string_view bytes);
  /// Makes the file visible under its name. Throws FileError; the target is then as it was.
  void commit();

 private:
  void flush();
  [[noreturn]] void fail(int error) const;

  std::filesystem::path target_, temporary_;  // temporary_ is empty when the target is written directly
  int descriptor_ = -1;
  std::string buffer_;
};

/// Writes a whole file. Throws FileError.
void write_file(const std::filesystem::path& target, std::string_view bytes);

}  // namespace carousel
