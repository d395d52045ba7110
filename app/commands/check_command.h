#pragma once

#include "app/run/prepare.h"

namespace carousel::app {

struct CheckArguments : ConfigArguments {
  bool graph = false;  ///< print the network as a graph, and nothing else
  bool json = false;   ///< print what is known of the configuration as JSON, errors included
};

/// `carousel check`: prints the resolved configuration, and as YAML comments the memory it needs and whether
/// it can deadlock, and the keys that the machine ignores; or the network as a graph, or all of it as JSON. With
/// `strict` warnings of the scene's import and ignored keys are errors. Returns the exit status.
int check_command(const CheckArguments& arguments);

}  // namespace carousel::app
