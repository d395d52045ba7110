#pragma once

#include <cstddef>
#include <functional>

#include "app/host/interrupt.h"
#include "app/sweep/ledger.h"
#include "app/sweep/process/worker_pool.h"
#include "app/sweep/results.h"

namespace carousel::app {

struct SweepOptions {
  std::size_t jobs = 1;
  bool quiet = false, retry_failed = false;
};

/// Fills the rows of points that have a file in the folder. With `retry_failed` those that failed count as missing.
void read_finished(const SweepSetup& setup, SweepRows& rows, bool retry_failed);

/// Puts the state of every point into the ledger.
void record(Ledger& ledger, const SweepRows& rows);

/// Runs the points that are missing, until all are over or an interrupt comes. A point that fails is a row with an
/// error. `ledger` may be null. Throws FileError if the folder cannot be written any more; what is finished is kept.
void run_missing(const SweepSetup& setup, const SweepOptions& options, SweepRows& rows, Ledger* ledger,
                 const InterruptScope& interrupt);

/// Writes the file of a point that failed before it wrote one, and fills its row. An error of kind `file` is thrown as
/// a FileError instead: it is not the point's fault.
void settle(const SweepSetup& setup, const WorkerPool::Finished& finished, SweepRow& row,
            const std::vector<ResultColumn>& columns);

}  // namespace carousel::app
