#include "app/commands/run_outputs.h"

#include <vector>

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "core/system/error.h"

namespace carousel::app {

namespace {

namespace fs = std::filesystem;

fs::path out_folder(const RunArguments& arguments) {
  if (!arguments.out.empty()) return arguments.out;
  return fs::path("out") / fs::path(arguments.config).stem();
}

struct Named {
  const char* option;
  const std::string& file;
  std::optional<ExtraFile>* extra;
};

/// Refuses two names of one file, and that of a result: one would replace the other. Devices take everything.
void require_own_files(const std::vector<Named>& files, const OutputFolder& folder) {
  std::error_code error;
  const auto real = [&](const Named& named) { return fs::weakly_canonical(fs::absolute(named.file), error); };
  for (std::size_t i = 0; i < files.size(); ++i) {
    const fs::path file = real(files[i]);
    if (fs::exists(file, error) && !fs::is_regular_file(file, error)) continue;
    const auto refuse = [&](const std::string& of) {
      throw ConfigError(files[i].option,
                        fmt::format("found {}, which is {}; expected a file of its own", files[i].file, of));
    };
    if (folder.holds_result(file)) refuse("a file of --out");
    for (std::size_t k = 0; k < i; ++k)
      if (real(files[k]) == file) refuse(fmt::format("the file of {}", files[k].option));
  }
}

}  // namespace

RunOutputs::RunOutputs(const RunArguments& arguments, const Config& config)
    : folder_(out_folder(arguments), &config, arguments.force, Results::kRun) {
  std::vector<Named> files;
  for (const Named& named : {Named{"--trace", arguments.trace.file, &trace_},
                             {"--dump-rays", arguments.dump_rays, &rays_},
                             {"--dump-trees", arguments.dump_trees, &trees_},
                             {"--dump-memory", arguments.dump_memory, &memory_}})
    if (!named.file.empty()) files.push_back(named);
  require_own_files(files, folder_);
  for (const Named& named : files) named.extra->emplace(named.option, named.file);
}

void RunOutputs::publish_extras() {
  for (std::optional<ExtraFile>* extra : {&trace_, &rays_, &trees_, &memory_})
    if (*extra) (*extra)->publish();
}

int RunOutputs::tell_errors(int status) const {
  for (const std::optional<ExtraFile>* extra : {&trace_, &rays_, &trees_, &memory_}) {
    if (!*extra || (*extra)->error().empty()) continue;
    spdlog::error("{}", (*extra)->error());
    if (status == kDone) status = kUsage;
  }
  return status;
}

}  // namespace carousel::app
