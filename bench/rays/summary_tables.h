#pragma once

#include <string>
#include <vector>

#include "bench/common/results.h"

namespace carousel::bench {

/// The ratios that the project has aims for, one row a scene and ray set: of CPU time between contestants, of
/// wall time between numbers of threads.
std::string summary_table(const std::vector<SceneResult>& scenes);
/// Machine, commit, compiler, date and settings, one line each.
std::string machine_text(const BenchResult& result);
/// What bench_kernels wrote with --benchmark_out=FILE --benchmark_out_format=json, as a table.
/// Throws std::runtime_error for a text that is not that.
std::string micro_table(const std::string& benchmark_json);

}  // namespace carousel::bench
