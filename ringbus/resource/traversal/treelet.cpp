#include "ringbus/resource/traversal/treelet.h"

#include "accel/traverse/kernels.h"

namespace carousel::ringbus {

void TreeletTraversal::test(Packet& packet, LocalRays& local, TestOutcome& outcome) {
  if (!treelets_.contains(packet.key)) return above_->test(packet, local, outcome);
  const accel::RayMembers members = context_.members(local.slots);
  // An engine's own tracer also counts the transforms.
  if (context_.subtree_tracer != nullptr)
    context_.subtree_tracer->trace(packet.key, members, outcome.counts);
  else
    accel::trace_interleaved(context_.accel, packet.key, members, outcome.counts);
  context_.any_hit.hold_back(local.slots);
  for (const std::uint32_t slot : local.slots) context_.completion.add_pending(slot, -1);
}

}  // namespace carousel::ringbus
