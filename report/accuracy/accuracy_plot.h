#pragma once

#include <string>

#include "report/accuracy/accuracy.h"

namespace carousel::report {

/// SVG: time a ray against wrong answers in parts per million of all rays asked (logarithmic, none at the foot), a dot
/// a row of levels with its name, the frontier as a line.
std::string accuracy_plot(const Accuracy& accuracy);

}  // namespace carousel::report
