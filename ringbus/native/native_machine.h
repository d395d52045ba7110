#pragma once

#include <memory>
#include <vector>

#include "accel/structure/accel.h"
#include "core/config/config.h"
#include "ringbus/native/links/link.h"
#include "ringbus/native/links/queue_link.h"
#include "ringbus/native/rank_gate.h"
#include "ringbus/protocol/machine.h"
#include "ringbus/queues/completed_queue.h"

namespace carousel::ringbus {

/// A machine with what the native engine adds to it: real queues between resources, and the queue to shading.
struct NativeMachine {
  /// The links come from `own_links` if that is not empty, and otherwise from the configuration. With
  /// a `transport` it is one rank's share of a machine. `threads` step it: number t of them every resource and every
  /// shader worker whose number here is t modulo `threads`. Throws a ConfigError where a design of queue does not
  /// serve so many.
  NativeMachine(const Config& config, const accel::Accel& accel, float scene_size, const LinkMaker& own_links,
                Transport* transport, std::size_t threads);

  Machine shared;
  std::vector<std::unique_ptr<Link>> links;  ///< as shared.topology.wires()
  /// By packet: the resource that it visits next. Written there when it goes on, and read by the nodes on its way,
  /// which pass it on. Empty unless packets are routed.
  std::vector<ResourceId> stops;
  CompletedQueue completed;
  std::unique_ptr<RankGate> gate;  ///< null: the whole machine is here
};

}  // namespace carousel::ringbus
