#pragma once

#include <string>
#include <vector>

#include "bench/common/results.h"

namespace carousel::bench {

/// The ratios for which the project has goals, one row a scene and ray set: of CPU time between contestants, of
/// wall time between numbers of threads.
std::string summary_table(const std::vector<SceneResult>& scenes);
/// Machine, commit, compiler, date and settings, one line each.
std::string machine_text(const BenchResult& result);
/// The results that bench_kernels wrote with --benchmark_out=FILE --benchmark_out_format=json, as a table.
/// Throws std::runtime_error for any other text.
std::string micro_table(const std::string& benchmark_json);

}  // namespace carousel::bench
