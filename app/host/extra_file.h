#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "core/system/atomic_file.h"

namespace carousel::app {

/// A file that a command writes beside its results because an option names it. It never costs the results: an error is
/// kept, told when the results are there, and changes the exit status. The file is there as a whole or as it was.
class ExtraFile {
 public:
  /// Tries that the file can be written, before any work that could be lost, and removes what killed runs left of it.
  /// Throws FileError. `option`: for errors.
  ExtraFile(std::string option, const std::filesystem::path& file);
  ExtraFile(const ExtraFile&) = delete;
  ExtraFile& operator=(const ExtraFile&) = delete;

  /// Calls `write`, and brings the bytes to the disk. Called once.
  void write(const std::function<void(AtomicFile&)>& write);
  /// Gives the file its name if it has been written without an error.
  void publish();

  const std::filesystem::path& name() const { return name_; }
  /// Empty if there is none.
  const std::string& error() const { return error_; }

 private:
  void keep_error(const std::function<void()>& work);

  std::string option_;
  std::filesystem::path name_;
  std::optional<AtomicFile> file_;
  std::string error_;
  bool written_ = false;
};

}  // namespace carousel::app
