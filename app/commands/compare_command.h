#pragma once

#include <string>

namespace carousel::app {

struct CompareArguments {
  std::string a, b;  ///< report.json files, or folders that hold one
  bool expect_identical = false;
};

/// `carousel compare`: prints "identical" if everything outside of `host` is equal, otherwise the differences. For two
/// runs of the cycle engine it also prints the first event that differs, found by running both again. Returns the exit
/// status.
int compare_command(const CompareArguments& arguments);

}  // namespace carousel::app
