#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/config/config.h"

namespace carousel::app {

/// The folder of a run's results. Its files are written to a hidden folder beside it, and appear together when the run
/// is over: the folder is there as a whole or as it was. Only where the folder holds files of other programs, or no
/// folder can be made beside it, are the files moved one by one, the report last and the old one removed first.
class OutputFolder {
 public:
  /// Tries that `folder` can be written, and removes what killed runs left. Throws FileError; and, unless `force` is
  /// given, ConfigError if the folder holds the results of another configuration.
  OutputFolder(const std::filesystem::path& folder, const Config& config, bool force);
  /// Without commit() the folder is left as it was.
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// The hidden folder, in which the files are made.
  const std::filesystem::path& staging() const { return staging_; }
  /// The folder where they will be.
  const std::filesystem::path& folder() const { return folder_; }
  /// Makes the files appear, and the files of an earlier run disappear. Throws FileError.
  void commit();

 private:
  bool make_staging(const std::filesystem::path& in);
  void remove_left_overs(const std::filesystem::path& in) const;
  void make_parents();
  void move_each() const;

  std::filesystem::path folder_, target_;  // target_: folder_ without symbolic links
  std::string prefix_;                     // of the names of hidden folders
  std::filesystem::path staging_;
  int lock_ = -1;                            // is held as long as the run lives
  std::vector<std::filesystem::path> made_;  // folders above, innermost last
};

/// True for the names of files that a run writes.
bool is_run_file(std::string_view name);

}  // namespace carousel::app
