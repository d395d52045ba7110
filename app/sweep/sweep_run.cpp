#include "app/sweep/sweep_run.h"

#include <map>
#include <optional>

#include <fmt/format.h>

#include "core/system/error.h"
#include "report/text/progress_line.h"
#include "report/text/ratio.h"

namespace carousel::app {

namespace {

constexpr int kWaitMs = 200;  // between looks for an interrupt

void set_row(Ledger& ledger, const SweepRow& row) {
  const char* state = !row.finished ? "waiting" : row.error ? "failed" : "done";
  ledger.set(row.point, state, row.seconds, row.error ? &*row.error : nullptr);
}

}  // namespace

void record(Ledger& ledger, const SweepRows& rows) {
  ledger.begin();
  for (const SweepRow& row : rows.rows) set_row(ledger, row);
  ledger.commit();
}

void read_finished(const SweepSetup& setup, SweepRows& rows, bool retry_failed) {
  for (SweepRow& row : rows.rows) {
    const std::filesystem::path path = point_path(setup.out, row.point.digest);
    if (std::error_code ignored; !std::filesystem::exists(path, ignored)) continue;
    const std::optional<PointFile> file = read_point(path);
    if (file && !(retry_failed && file->error)) fill_row(row, rows.columns, *file);
  }
}

void settle(const SweepSetup& setup, const WorkerPool::Finished& finished, SweepRow& row,
            const std::vector<ResultColumn>& columns) {
  if (finished.error && finished.error->kind == "file")
    throw FileError(finished.error->text + "; the points that are finished are kept, and the same command goes on");
  if (finished.error && finished.error->kind != "verification")
    write_point(setup.out, finished.point, finished.seconds, finished.error, nullptr);
  const std::optional<PointFile> file = read_point(point_path(setup.out, finished.point.digest));
  if (!file) throw FileError("cannot read " + point_path(setup.out, finished.point.digest).string());
  fill_row(row, columns, *file);
}

void run_missing(const SweepSetup& setup, const SweepOptions& options, SweepRows& rows, Ledger* ledger,
                 const InterruptScope& interrupt) {
  std::map<std::string, SweepRow*> by_digest;
  WorkerPool pool(setup, options.jobs);
  std::size_t total = 0, over = 0;
  for (SweepRow& row : rows.rows) {
    by_digest[row.point.digest] = &row;
    if (row.finished) continue;
    pool.add(row.point);
    ++total;
  }

  std::optional<report::ProgressLine> line;
  if (!options.quiet) line.emplace(stderr);
  const auto started = [&](const SweepPoint& point) {
    if (ledger != nullptr) ledger->set(point, "running");
  };
  while (pool.busy() && !interrupt.interrupted()) {
    for (const WorkerPool::Finished& finished : pool.step(kWaitMs, -1, started)) {
      SweepRow& row = *by_digest.at(finished.point.digest);
      settle(setup, finished, row, rows.columns);
      ++over;
      if (ledger != nullptr) set_row(*ledger, row);
    }
    if (line) line->update(report::ratio(over, total), over, "points");
  }
}

}  // namespace carousel::app
