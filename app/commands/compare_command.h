#pragma once

#include <string>
#include <vector>

namespace carousel::app {

struct CompareArguments {
  std::vector<std::string> runs;  ///< two or more report.json files, or folders that hold one
  std::string only;               ///< pattern of rows and keys to show; empty: all
  bool expect_identical = false, all = false, json = false;
  std::string html;  ///< page to write; empty: none
};

/// `carousel compare`: prints "identical" if everything outside of `host` is equal; otherwise the runs side by side
/// (report/compare/comparison.h). For two runs of the cycle engine that ought to be equal, or with --all, it also
/// prints the first event that differs, found by running both again. Returns the exit status.
int compare_command(const CompareArguments& arguments);

}  // namespace carousel::app
