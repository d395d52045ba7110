#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "app/run/counting_workload.h"
#include "report/text/progress_line.h"
#include "ringbus/results/run_result.h"

namespace carousel::app {

/// Shows on the terminal how far a run over `counting` has come, which begins with `first_rays` rays; null if `quiet`.
/// The line disappears with the result, which must live as long as the run; so must `counting`.
inline std::unique_ptr<report::ProgressLine> show_rays(ringbus::RunOptions& options, const CountingWorkload& counting,
                                                       std::uint64_t first_rays, std::string stage, bool quiet) {
  if (quiet) return nullptr;
  auto line = std::make_unique<report::ProgressLine>(stderr);
  options.progress = [&counting, first_rays, stage = std::move(stage), shown = line.get()](std::uint64_t completed) {
    const double part = first_rays == 0 ? 0.0 : double(counting.generated()) / double(first_rays);
    shown->update(part, completed, "rays", stage);
  };
  return line;
}

}  // namespace carousel::app
