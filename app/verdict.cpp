#include "app/verdict.h"

#include <spdlog/spdlog.h>

namespace carousel::app {

ExitStatus verdict(const report::Report& report) {
  const bool failed = report.verify && report.verify->mismatches > 0;
  if (report.incomplete) spdlog::warn("interrupted; report and picture are partial");
  if (failed)
    spdlog::error("verification failed: {} of {} rays differ from the reference tracer",
                  report.verify->mismatches, report.verify->compared);
  if (report.incomplete) return kInterrupted;
  return failed ? kBroken : kDone;
}

}  // namespace carousel::app
