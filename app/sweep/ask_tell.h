#pragma once

#include "app/sweep/sweep_run.h"

namespace carousel::app {

/// Lets another program choose the points: reads them from standard input, a JSON object of keys and values a line,
/// runs them, and prints the row of each as a line of JSON as soon as it is finished, in the order in which they
/// finish. A point that has a file is told at once. A line that is no point is told with status `invalid`, and all
/// lines name the same keys. Returns at the end of the input, with all rows in `rows`, or after an interrupt. Throws
/// FileError.
void ask_and_tell(const SweepSetup& setup, const SweepOptions& options, PointMaker& maker, SweepRows& rows,
                  Ledger& ledger, const InterruptScope& interrupt);

}  // namespace carousel::app
