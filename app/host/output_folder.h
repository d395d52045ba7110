#pragma once

#include <cstdint>
#include <exception>
#include <filesystem>
#include <functional>
#include <vector>

#include "core/config/config.h"

namespace carousel::app {

/// The commands whose results a folder may hold, side by side if they are of one configuration.
enum class Results : std::uint8_t { kRun, kAccuracy, kStress, kVersus };

/// The folder of a command's results. Its files are written to a hidden folder beside it, and appear together when the
/// run is over: the folder is there as a whole or as it was. Only where the folder holds files of other programs, or no
/// folder can be made beside it, are the files moved one by one, the report last and the old one removed first.
class OutputFolder {
 public:
  /// Tries that `folder` can be written, and removes what killed runs left. Throws FileError; and, unless `force` is
  /// given, ConfigError if the folder holds the results of another configuration. `config` is null where there is none.
  OutputFolder(const std::filesystem::path& folder, const Config* config, bool force, Results results);
  /// Without commit() the folder is left as it was.
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// The hidden folder, in which the files are made.
  const std::filesystem::path& staging() const { return staging_; }
  /// The folder where they will be.
  const std::filesystem::path& folder() const { return folder_; }
  /// True for the name of a file that a command writes to this folder.
  bool holds_result(const std::filesystem::path& file) const;
  /// Makes the files appear, and those of an earlier run of the command disappear; those of other commands too, if
  /// they are of another configuration. Throws FileError.
  void commit();
  /// Calls `write` with the hidden folder, and commits. Returns the FileError if the files cannot be written, so that
  /// the caller may print its result first.
  std::exception_ptr write(const std::function<void(const std::filesystem::path& staging)>& write);

 private:
  bool make_staging(const std::filesystem::path& target);
  bool fail_staging();
  void remove_made();
  bool is_replaced(const std::string& name) const;
  bool holds_only_replaced() const;
  void move_each() const;

  std::filesystem::path folder_, target_;  // target_: folder_ without symbolic links
  Results results_;
  bool of_another_ = false;  // the folder holds results of another configuration
  std::filesystem::path staging_;
  int lock_ = -1;                            // is held as long as the run lives
  std::vector<std::filesystem::path> made_;  // folders above, innermost last
};

}  // namespace carousel::app
