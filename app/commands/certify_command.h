#pragma once

#include "app/commands/accuracy_command.h"

namespace carousel::app {

/// `carousel accuracy --certify`: tries hard cases of everything the levels of accuracy promise. Prints counts, and of
/// each promise that was broken a case that shows it. Returns the exit status: kBroken if any was.
int certify_command(const AccuracyArguments& arguments);

/// `carousel accuracy --reproduce`: tries one case again, or every case in a file, and prints what the level and what
/// exact arithmetic answered. Returns kBroken if one is still broken, promised or not.
int reproduce_command(const AccuracyArguments& arguments);

}  // namespace carousel::app
