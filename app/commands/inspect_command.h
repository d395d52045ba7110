#pragma once

#include <string>
#include <vector>

namespace carousel::app {

struct InspectArguments {
  std::string scene;              ///< a file, or builtin:<name>
  std::vector<std::string> sets;  ///< keys of the configuration it would be run with
  std::string frame;              ///< name of a node to be seen; empty: the scene is listed
  bool json = false;
};

/// `carousel inspect`: lists a scene's contents and the effects that it calls for, or with `frame` writes the keys of a
/// camera that sees the node. Returns the exit status.
int inspect_command(const InspectArguments& arguments);

}  // namespace carousel::app
