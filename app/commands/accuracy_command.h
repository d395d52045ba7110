#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "app/run/prepare.h"

namespace carousel::app {

struct AccuracyArguments : ConfigArguments {  // without a configuration: kBuiltInConfig
  std::filesystem::path out;
  bool json = false, table = false, quiet = false, force = false;
  std::size_t rays = 50000;       ///< most rays of the scene
  std::size_t hard_rays = 20000;  ///< rays of each hard case
  int repetitions = 5;
  int seeds = 4;  ///< number of the picture's seeds, over which the machines' cycles are measured
  std::uint64_t seed = 1;
  bool certify = false;   ///< run certify_command() instead
  std::string reproduce;  ///< not empty: run reproduce_command() with this instead
  std::optional<std::uint64_t> cases;
  double seconds = 10;
};

/// The configuration that is used if none is given.
inline constexpr const char* kBuiltInConfig =
    "schema_version: 1\nscene: {builtin: instances}\nimage: {width: 96, height: 96, samples: 2}\n";

/// `carousel accuracy`: compares every sensible combination of levels with exact arithmetic, on the scene and on the
/// built-in hard ones; prints five lines, or with `table` all tables, and writes accuracy.json and accuracy.html.
/// Returns the exit status.
int accuracy_command(const AccuracyArguments& arguments);

}  // namespace carousel::app
