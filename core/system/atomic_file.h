#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace carousel {

/// A file that appears under its name completely or not at all: it is written beside its target, flushed to the disk
/// and renamed. A target that is no regular file (a pipe, /dev/stdout) is written to directly. Missing folders are
/// created. Not for several threads at once.
///
/// The unfinished file is `.<name>.<process>.<number>.partial` and is locked (flock) until it has its name. So whoever
/// finds one that is not locked knows that its writer was killed, whether or not another process has its number by now.
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

/// Removes the unfinished files in `folder` whose writers were killed. Writers that are at work, on this machine or
/// another one, keep theirs. Waits up to a second for them, since a killed process does not end at once. On a file
/// system without locks all stay.
void remove_abandoned(const std::filesystem::path& folder);

}  // namespace carousel
