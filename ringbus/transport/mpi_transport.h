#pragma once

#include <chrono>
#include <functional>
#include <memory>
#include <string>

#include "ringbus/transport/transport.h"

namespace carousel::ringbus {

/// Ranks that are processes of MPI (Open MPI), on one host or on many. There is one in a process, once.
///
/// No call waits for a rank that has died or hangs: messages go from rank to rank and are polled, and no collective
/// operation is used, since one cannot be given up. Five times a second each rank sends the others a sign of life, from
/// a thread of its own, and looks for theirs. A thread rather than a count of progress: a rank that loads a scene for
/// minutes, in libraries that know nothing of us, goes on to give signs, and needs no word in any loader; a process
/// that is stopped, or whose host is gone, stops with all its threads. A rank that lives but makes no progress while
/// rays are traced is found there (RankGate). A rank that finds itself late, since it was stopped with the others,
/// forgives them.
///
/// A rank that waits for others throws when one of them is missing. One that is busy meanwhile, and will not wait for
/// them soon, is ended by that thread.
class MpiTransport : public Transport {
 public:
  /// Tells the user of a rank that is missing, on every rank before any of them ends: mpirun ends the others with the
  /// first. Any thread calls it.
  using Say = std::function<void(const std::string&)>;
  /// Leaves the ranks: waits for all of them to leave. Throws a SimulationError where one is missing.
  virtual void leave() = 0;
  /// Leaves the ranks as leave() does, but gives up where others do not leave in time, or are missing. When this
  /// process ends then, mpirun ends the others.
  virtual void leave_within(std::chrono::milliseconds time) = 0;
};

/// The interface of the module that makes them (core/module/module.h).
struct MpiModule {
  static constexpr const char* kModule = "mpi";

  /// Joins the ranks that mpirun has started; without mpirun the process is the only rank. Throws a FileError where MPI
  /// lacks a thread level that it needs.
  std::unique_ptr<MpiTransport> (*start)(const MpiTransport::Say& say) = nullptr;
};

}  // namespace carousel::ringbus
