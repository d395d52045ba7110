#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/types/workload.h"
#include "ringbus/protocol/machine.h"
#include "ringbus/queues/completed_queue.h"
#include "ringbus/ranks/rank_message.h"

namespace carousel::ringbus {

/// The hits of rays that completed at other ranks, on their way to the shader workers here. One thread at a time calls.
class RemoteResults {
 public:
  /// Keeps references.
  RemoteResults(Machine& machine, CompletedQueue& completed) : machine_(machine), completed_(completed) {}

  /// Results have come: their rays' slots are free.
  void take(std::span<const ResultOnWire> results);
  /// Hands all results over to the shader workers, unless their queue is full.
  void hand_over();

 private:
  Machine& machine_;
  CompletedQueue& completed_;
  HitBatch results_;
  std::vector<std::uint32_t> slots_;  // scratch
};

}  // namespace carousel::ringbus
