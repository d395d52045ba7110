#pragma once

#include <string>

namespace carousel::app {

struct CompareArguments {
  std::string a, b;  ///< report.json files, or folders that hold one
  bool expect_identical = false;
};

/// `carousel compare`: says "identical" when all outside of `host` is equal, else what differs; of two runs of the
/// cycle engine also the first thing that went differently, found by running both again. Returns the exit status.
int compare_command(const CompareArguments& arguments);

}  // namespace carousel::app
