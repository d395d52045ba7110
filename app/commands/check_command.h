#pragma once

#include "app/run/prepare.h"

namespace carousel::app {

using CheckArguments = ConfigArguments;

/// `carousel check`: prints the resolved configuration, and as YAML comments the memory it needs and whether
/// it can deadlock, and the keys that the machine ignores. Returns the exit status.
int check_command(const CheckArguments& arguments);

}  // namespace carousel::app
