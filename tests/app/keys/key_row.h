#pragma once

#include <string>
#include <vector>

#include "tests/app/keys/base_machines.h"

namespace carousel {

/// A key of the configuration and a machine on which it matters.
struct KeyRow {
  std::string key;
  BaseMachine machine;
  std::vector<std::string> sets{};    ///< that the machine has besides
  std::vector<std::string> values{};  ///< to try; empty: all names of an enumeration, or both values of a switch
  std::vector<std::string> with{};    ///< set together with the values, which are refused without
};

}  // namespace carousel
