#include "app/build_report/verdict.h"

#include <spdlog/spdlog.h>

namespace carousel::app {

ExitStatus verdict(const report::Report& report, ExitStatus interrupted) {
  const bool failed = report.verify && report.verify->mismatches > 0;
  if (report.incomplete) spdlog::warn("interrupted; the report is partial");
  if (failed)
    spdlog::error("verification failed: {} of {} rays differ from the reference tracer", report.verify->mismatches,
                  report.verify->compared);
  const auto& proof = report.shading.proof;
  const bool changed = proof && !(proof->same_hits && proof->same_image);
  if (changed)
    spdlog::error("with all effects the {} differ: something was left out that the scene calls for",
                  proof->same_hits ? "pixels" : "hits");
  const bool harmed = report.faults && !report.faults->same_hits.value_or(true);
  if (harmed) spdlog::error("without faults hits or picture differ");
  if (report.incomplete) return interrupted;
  return failed || changed || harmed ? kBroken : kDone;
}

}  // namespace carousel::app
