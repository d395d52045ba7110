#pragma once

#include <string>

#include "report/accuracy/accuracy.h"

namespace carousel::report {

/// SVG of two panels with one vertical axis: wrong answers in parts per million of all rays asked (logarithmic, none at
/// the foot) against time a ray on the host, and against cycles a ray of the machine in which the testers limit. A dot
/// a row of levels, with a number that the list beside the panels names; each frontier as a line. No two numbers
/// overlap.
std::string accuracy_plot(const Accuracy& accuracy);

}  // namespace carousel::report
