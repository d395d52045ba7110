#pragma once

#include <string>
#include <vector>

namespace carousel::app {

struct InspectArguments {
  std::string scene;              ///< a file, or builtin:<name>
  std::vector<std::string> sets;  ///< keys of the configuration it would be run with
  bool json = false;
};

/// `carousel inspect`: lists a scene's contents and the effects that it calls for. Returns the exit status.
int inspect_command(const InspectArguments& arguments);

}  // namespace carousel::app
