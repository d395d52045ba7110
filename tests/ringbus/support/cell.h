#pragma once

#include <cstddef>
#include <stop_token>
#include <string>

#include "core/config/config.h"
#include "ringbus/cycle/cycle_engine.h"

namespace carousel::ringbus {

/// One machine to run a workload on: a configuration, and settings of the test.
struct Cell {
  Config config;
  std::size_t threads = 1;
  bool tight_storage = false;  ///< bounded collection storage at its least
  cycle::TraceWindow trace{};  ///< window in which the cycle engine keeps its steps
  std::size_t samples = 0;     ///< most samples of the time series
  TimelineOptions timeline{};  ///< slices of time that are recorded
  std::stop_token stop{};      ///< ends the run, which is then incomplete
  bool non_opaque = false;     ///< half of the scene's triangles, and spheres; rays have flags
  float away = 0.5f;           ///< rays start within so many extents of the scene around it

  /// Sets what a key of the tests' factors that begins with `test.` concerns. Throws a std::logic_error for an unknown
  /// key.
  void set(const std::string& key, const std::string& value);
  /// The settings that differ from the defaults, as assignments "key=value".
  std::string text() const;
};

/// True if a user may configure the machine; any built-in scene will do.
bool is_accepted(const Config& config);

}  // namespace carousel::ringbus
