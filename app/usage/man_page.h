#pragma once

#include <string>
#include <vector>

#include "app/usage/usage.h"

namespace carousel::app {

/// The manual page carousel(1), in the macros of man(7).
std::string man_page(const ProgramUsage& program, const std::vector<KeyUsage>& keys, const std::string& version);

}  // namespace carousel::app
