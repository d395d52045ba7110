#pragma once

#include <filesystem>

#include "app/run/prepare.h"
#include "app/sweep/plan/point.h"
#include "app/sweep/process/point_file.h"

namespace carousel::app {

/// The settings that all points of a sweep share.
struct SweepSetup {
  std::filesystem::path config;  ///< the file of `source`, which says where to look for the files that it names
  ConfigText source;
  std::filesystem::path out;
};

/// Runs a point and writes its file. `prepared` holds the scene of the point's group, and gets the configuration of the
/// point. The error that it returns is not written yet, but for a failed verification. For a process of its own.
std::optional<PointError> run_point(const SweepSetup& setup, Prepared& prepared, const SweepPoint& point);

/// The error of an exception that is being handled.
PointError current_error();

}  // namespace carousel::app
