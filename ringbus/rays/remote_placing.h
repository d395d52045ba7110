#pragma once

#include <span>

#include "core/types/ids.h"
#include "core/types/workload.h"
#include "ringbus/rays/ray_group.h"
#include "ringbus/rays/ray_id.h"

namespace carousel::ringbus {

/// Brings new rays to resources of other ranks. RayControl calls it, one thread at a time.
class RemotePlacing {
 public:
  virtual ~RemotePlacing() = default;
  /// The data of rays whose slots have been leased from a resource of another rank set out for it. Each has its ID.
  virtual void load(ResourceId resource, std::span<const RayId> ids, std::span<const RayRequest> rays) = 0;
  /// The group's rays have all been placed, some of them by load(). The group goes to `issuer` by
  /// RayControl::deliver(), but not before their data have come: a packet might be there sooner.
  virtual void hold(ResourceId issuer, RayGroup&& group) = 0;
};

}  // namespace carousel::ringbus
