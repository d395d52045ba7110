#pragma once

#include <string>

#include "report/compare/comparison.h"

namespace carousel::report::html {

/// The page of `carousel compare`; with `all` it lists every value that differs.
std::string compare_page(const Comparison& comparison, bool all);

}  // namespace carousel::report::html
