#pragma once

#include <chrono>
#include <memory>

#include "ringbus/transport/transport.h"

namespace carousel::ringbus {

/// Ranks that are processes of MPI (Open MPI), on one host or on many. There is one in a process, once.
class MpiTransport : public Transport {
 public:
  /// Joins the ranks that mpirun has started; without mpirun the process is the only rank. Null where the program was
  /// built without MPI (CAROUSEL_MPI). Throws a FileError where MPI lacks a thread level that it needs.
  static std::unique_ptr<MpiTransport> start();
  /// Whether start() makes one.
  static bool built();

  /// Leaves the ranks: waits for all of them to leave.
  virtual void leave() = 0;
  /// The same, but gives up where others do not leave in time. When this process ends then, mpirun ends the others.
  virtual void leave_within(std::chrono::milliseconds time) = 0;
};

}  // namespace carousel::ringbus
