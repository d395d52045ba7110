#pragma once

#include <string>
#include <utility>
#include <vector>

namespace carousel::ringbus {

/// One key that machines of the tests differ in. Keys that begin with `test.` concern the test (Cell), all others are
/// key paths of the configuration. Values are written as in a configuration file.
struct Factor {
  std::string key;
  std::vector<std::string> values;
  /// Conditions on other keys, `key=value` or `key!=value`. Unless all hold, the machine does not read this key, and
  /// the key is left out.
  std::vector<std::string> needs = {};
};

/// Every key that must not change a hit beyond what the level of accuracy says, each with values worth trying. A factor
/// stands behind those that it needs.
const std::vector<Factor>& machine_factors();

/// The list of machine_factors() with other values for some keys.
std::vector<Factor> machine_factors_with(const std::vector<std::pair<std::string, std::vector<std::string>>>& changes);

}  // namespace carousel::ringbus
