#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "app/run/prepare.h"

namespace carousel::app {

struct SweepArguments : ConfigArguments {
  std::vector<std::string> vary, exclude, scenes;
  std::optional<std::size_t> points;  ///< points of a Latin hypercube; absent: the whole grid
  std::uint64_t seed = 1;
  std::int64_t repeat = 1;
  std::size_t jobs = 0;  ///< 0: as many as cores
  std::string shard;     ///< "I/N"; empty: all points
  std::vector<std::string> merge;
  std::vector<std::string> results;
  std::string sampled;  ///< part of the frame that each point simulates; empty: as configured
  std::string pareto, out;
  bool dry_run = false, retry_failed = false, ask = false, tell = false, json = false, quiet = false;
};

/// `carousel sweep`: many runs of one configuration with other values of some keys. Returns the exit status: kBroken if
/// a point failed.
int sweep_command(const SweepArguments& arguments);

}  // namespace carousel::app
