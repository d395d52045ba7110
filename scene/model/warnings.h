#pragma once

#include <functional>
#include <string>

namespace carousel::scene {

/// Takes one warning, a sentence without a newline. May be empty: warnings are then dropped.
using WarningSink = std::function<void(const std::string&)>;

}  // namespace carousel::scene
