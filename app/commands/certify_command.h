#pragma once

#include "app/commands/accuracy_command.h"

namespace carousel::app {

/// `carousel accuracy --certify`: tests hard cases of every promise of the levels of accuracy. Prints counts, and for
/// each broken promise a case that shows it. Returns the exit status: kBroken if a promise was broken.
int certify_command(const AccuracyArguments& arguments);

/// `carousel accuracy --reproduce`: tests one case again, or every case in a file, and prints the answers of the level
/// and of exact arithmetic. Returns kBroken if a case is still broken, promised or not.
int reproduce_command(const AccuracyArguments& arguments);

}  // namespace carousel::app
