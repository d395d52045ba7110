#pragma once

#include <string>

namespace carousel {

/// What docs/reference/config is written from: every key with its values, default, unit and meaning, and the engines
/// that take a value.
std::string config_markdown();

}  // namespace carousel
