#include "app/host/rank_scope.h"

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <string_view>
#include <vector>

#include <fmt/format.h>
#include <spdlog/sinks/sink.h>
#include <spdlog/spdlog.h>

#include "core/config/write.h"
#include "core/module/module.h"
#include "core/system/error.h"

namespace carousel::app {

namespace {

/// True in a process made by a starter of parallel programs: Open MPI's mpirun, or srun with PMIx or PMI 2.
bool started_as_rank() {
  const char* const names[] = {"OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK"};
  return std::any_of(std::begin(names), std::end(names), [](const char* name) { return std::getenv(name) != nullptr; });
}

const ringbus::MpiModule& mpi_module() {
  try {
    return open_module<ringbus::MpiModule>();
  } catch (const ModuleError& error) {
    throw ConfigError("engine.transport", fmt::format("{}; expected local, found mpi", error.what()));
  }
}

/// The first line in which two texts differ, of both.
std::string difference(const std::string& ours, const std::string& theirs) {
  const auto line_at = [](const std::string& text, std::size_t at) {
    const std::size_t begin = at == 0 ? 0 : text.rfind('\n', at - 1) + 1;
    return text.substr(begin, text.find('\n', at) - begin);
  };
  const auto at = static_cast<std::size_t>(std::mismatch(ours.begin(), ours.end(), theirs.begin(), theirs.end()).first -
                                           ours.begin());
  if (at >= ours.size() || at >= theirs.size()) return "one has more keys";
  return fmt::format("'{}' against '{}'", line_at(ours, at), line_at(theirs, at));
}

}  // namespace

void require_mpi_module() {
  mpi_module();
}

RankScope::RankScope(const Config& config, const std::string& program) {
  const ringbus::MpiModule& module = mpi_module();
  if (!started_as_rank())
    throw ConfigError(
        "engine.transport",
        "mpirun has not started this program, as in mpirun -n 2 carousel run ...; expected local, found mpi");
  transport_ = module.start([](const std::string& text) { spdlog::error("{}", text); });
  for (const auto& sink : spdlog::default_logger()->sinks())
    sink->set_pattern(fmt::format("rank {}: %^%l%$: %v", rank()));
  require_same("program", program);
  require_same("configuration", resolved_yaml(config));
  require_room(config);
}

RankScope::~RankScope() {
  if (transport_ && !left_) transport_->leave_within(std::chrono::seconds(3));
}

void RankScope::require_same(const std::string& what, const std::string& digest) {
  const std::vector<std::string> all = transport_->gather(digest);
  for (std::uint32_t r = 1; r < all.size(); ++r)
    if (all[r] != all[0])
      throw ConfigError("engine.transport",
                        fmt::format("rank {} has another {} than rank 0: {}; expected the same on all ranks", r, what,
                                    difference(all[r], all[0])));
}

void RankScope::require_files(const std::function<std::string()>& digest) {
  std::string own, error;
  try {
    own = digest();
  } catch (const FileError& e) {
    error = e.what();
  }
  const std::vector<std::string> errors = transport_->gather(error);
  for (std::uint32_t r = 0; r < errors.size(); ++r)
    if (!errors[r].empty())
      throw ConfigError("engine.transport",
                        fmt::format("rank {}: {}; expected the files on the hosts of all ranks", r, errors[r]));
  require_same("content of the scene's files", own);
}

void RankScope::require_room(const Config& config) const {
  const std::int64_t ranks = transport_->ranks();
  if (ranks > config.topology.resources)
    throw ConfigError("topology.resources",
                      fmt::format("each rank plays one resource at least; expected at least {} for the {} "
                                  "ranks, found {}; rank {} would have none",
                                  ranks, ranks, config.topology.resources, config.topology.resources));
  if (ranks > config.rays.slots_per_resource)
    throw ConfigError("rays.slots_per_resource",
                      fmt::format("each rank fills one slot of a resource at least; expected at least "
                                  "{}, found {}; rank {} would have none",
                                  ranks, config.rays.slots_per_resource, config.rays.slots_per_resource));
}

void RankScope::leave() {
  transport_->leave();
  left_ = true;
}

}  // namespace carousel::app
