#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "bench/rays/contestants.h"
#include "core/config/config.h"

namespace carousel::bench {

/// The command line of bench_rays.
struct Options {
  std::vector<std::string> builtins{"terrain", "spheres"};
  std::vector<std::int64_t> sizes{100'000};
  std::vector<std::string> files;
  std::vector<std::string> sets;    ///< empty: all
  std::uint32_t image_side = 1024;  ///< side in pixels of the primary rays' image
  std::uint64_t seed = 1;
  std::vector<int> threads{1, 2};
  int repetitions = 5;
  bool quick = false;
  bool build = true;
  RingSettings ring;
  BvhConfig bvh;
  Field field;
  std::string json;                   ///< file for the results
  std::vector<std::string> from;      ///< results to tabulate instead of measuring
  std::vector<std::string> markdown;  ///< documents whose tables are replaced
  std::string micro;                  ///< results of bench_kernels, tabulated as well

  /// The settings that the results name, as key and value.
  std::map<std::string, std::string> describe() const;
};

/// Empty if the program has to end with `exit_status` (help, or an error that has been printed).
std::optional<Options> parse_options(int argc, char** argv, int& exit_status);

}  // namespace carousel::bench
