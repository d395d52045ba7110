#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace carousel {

/// A file that appears under its name completely or not at all: it is written beside its target, flushed to the disk
/// and renamed. A target that is no regular file (a pipe, /dev/stdout) is written to directly. Missing folders are
/// created. Not for several threads at once. core/system/unfinished.h says how the unfinished file is called, and who
/// removes it when its writer was killed.
class AtomicFile {
 public:
  /// Throws FileError when the file cannot be made, and Interrupted where nobody reads a pipe.
  explicit AtomicFile(const std::filesystem::path& target);
  /// Without commit() the target is left as it was, and nothing stays beside it, nor a folder that was made for it.
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// Appends. Throws FileError (disk full, quota).
  void write(std::string_view bytes);
  /// Brings all bytes to the disk, so that commit() has no more to write. Throws FileError.
  void finish();
  /// Makes the file visible under its name. Throws FileError; the target is then as it was, or whole where only its
  /// folder could not be flushed.
  void commit();

 private:
  void flush();
  void discard();
  [[noreturn]] void fail(int error) const;

  std::filesystem::path target_, unfinished_;  // unfinished_ is empty when the target is written directly
  std::vector<std::filesystem::path> made_;    // folders, outermost first
  int descriptor_ = -1;
  bool finished_ = false;
  std::string buffer_;
};

/// Writes a whole file, and removes what killed writers of this file left beside it. Throws FileError.
void write_file(const std::filesystem::path& target, std::string_view bytes);

}  // namespace carousel
