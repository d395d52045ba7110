#include "ringbus/cycle/rings/ring_fabric.h"

#include "ringbus/cycle/rings/grant_ring.h"
#include "ringbus/cycle/rings/slot_ring.h"

namespace carousel::ringbus::cycle {

std::unique_ptr<RingFabric> make_ring(const RingShape& shape, std::vector<RingEnd*> ends, RingLinks links) {
  if (shape.grants) return std::make_unique<GrantRing>(shape, std::move(ends), std::move(links));
  return std::make_unique<SlotRing>(shape, std::move(ends), std::move(links));
}

}  // namespace carousel::ringbus::cycle
