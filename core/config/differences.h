#pragma once

#include <string>
#include <vector>

#include "core/config/config.h"

namespace carousel {

/// The assignments `key.path=value` that make `to` of `from`, in the order of the keys, as `--set` takes them. A list
/// is assigned whole.
std::vector<std::string> config_differences(const Config& from, const Config& to);

}  // namespace carousel
