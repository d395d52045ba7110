#pragma once

#include <ostream>

#include "tests/core/config/config_issues.h"

namespace carousel {

/// A configuration that is refused with one message.
struct BadConfig {
  const char* name;
  const char* text;
  const char* message;

  friend void PrintTo(const BadConfig& bad, std::ostream* out) { *out << bad.name; }
};

}  // namespace carousel
