#pragma once

#include <string>

namespace carousel {

/// The page docs/reference/config.md: every key with its values, default, unit and meaning, and the engines that take a
/// value.
std::string config_markdown();

}  // namespace carousel
