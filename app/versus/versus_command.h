#pragma once

#include <cstdint>
#include <string>

#include "app/run/prepare.h"

namespace carousel::app {

struct VersusArguments : ConfigArguments {
  std::uint64_t seeds = 3;
  bool no_search = false;
  std::string out;  ///< folder; empty: out/<name of the configuration>-versus
  bool json = false, quiet = false, force = false;
};

/// `carousel versus`: this machine against the conventional one with the same units, memory and rays, and against that
/// at equal area; prints five lines and writes versus.json and versus.html. Returns the exit status.
int versus_command(const VersusArguments& arguments);

}  // namespace carousel::app
