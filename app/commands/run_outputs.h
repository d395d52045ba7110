#pragma once

#include <optional>

#include "app/commands/run_command.h"
#include "app/host/exit_status.h"
#include "app/host/extra_file.h"
#include "app/host/output_folder.h"

namespace carousel::app {

/// All outputs of a run: its folder, and the files that options name. All are tried before any work that could be lost,
/// and get their names when it is done, the folder last. Each is there as a whole or as it was.
class RunOutputs {
 public:
  /// Throws FileError, and ConfigError if two outputs are one file or the folder has results of another configuration.
  RunOutputs(const RunArguments& arguments, const Config& config);

  OutputFolder& folder() { return folder_; }
  /// Null if the option is not given.
  ExtraFile* trace() { return trace_ ? &*trace_ : nullptr; }
  ExtraFile* rays() { return rays_ ? &*rays_ : nullptr; }
  ExtraFile* trees() { return trees_ ? &*trees_ : nullptr; }
  ExtraFile* memory() { return memory_ ? &*memory_ : nullptr; }

  /// Gives the files of options their names.
  void publish_extras();
  /// Tells the errors of these files. Returns the status of the run, or that of a file error if the run was done.
  int tell_errors(int status) const;

 private:
  OutputFolder folder_;
  std::optional<ExtraFile> trace_, rays_, trees_, memory_;
};

}  // namespace carousel::app
