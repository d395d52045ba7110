#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "core/config/load/load.h"
#include "ringbus/transport/mpi_transport.h"

namespace carousel::app {

/// Makes sure that the module "mpi" is there and can be opened. Throws a ConfigError that names it and its package.
void require_mpi_module();

/// This process as a rank of a run with `engine.transport: mpi`, from the reading of its configuration to the writing
/// of results, which rank 0 does. Messages on the terminal name the rank from here on.
class RankScope {
 public:
  /// Joins the ranks that mpirun has started. Throws a ConfigError that names the rank where this program has no MPI,
  /// where nobody has started ranks, where there are more than the machine takes, or where a rank has another program
  /// or another configuration. `program` tells this program apart.
  RankScope(const Config& config, const std::string& program);
  /// Without leave() the ranks have failed: waits a little for them, so that each can say why.
  ~RankScope();
  RankScope(const RankScope&) = delete;
  RankScope& operator=(const RankScope&) = delete;

  ringbus::Transport& transport() { return *transport_; }
  std::uint32_t rank() const { return transport_->rank(); }
  std::uint32_t ranks() const { return transport_->ranks(); }
  /// Makes sure that all ranks hold the same in `what`, e.g. the scene, of which `digest` tells. Every rank calls.
  /// Throws a ConfigError.
  void require_same(const std::string& what, const std::string& digest);
  /// Makes sure that all ranks hold the same files that the configuration names, of which `digest` tells. A file that
  /// this rank cannot read is an error of all ranks, before any of them begins to load.
  void require_files(const std::function<std::string()>& digest);
  /// Waits until all ranks are done.
  void leave();

 private:
  void require_room(const Config& config) const;

  std::unique_ptr<ringbus::MpiTransport> transport_;
  bool left_ = false;
};

}  // namespace carousel::app
