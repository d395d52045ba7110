#pragma once

#include <string>

#include "report/accuracy/accuracy.h"

namespace carousel::report {

/// What was measured, on a line: scene, rays, repetitions and pictures.
std::string accuracy_head(const Accuracy& accuracy);

/// For a terminal, a line a fact: what safety costs on the host and on the machine, what goes wrong without it, and
/// which levels to choose.
std::string accuracy_summary(const Accuracy& accuracy);

}  // namespace carousel::report
