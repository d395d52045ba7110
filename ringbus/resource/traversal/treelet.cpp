#include "ringbus/resource/traversal/treelet.h"

#include "accel/traverse/kernels.h"

namespace carousel::ringbus {

namespace {

// Lists of rays pay where there are rays enough to be several at most nodes: as measured, up to some 256 triangles a
// ray, 131072 triangles for 512 (docs/internals/data/speeds.md).
constexpr std::size_t kFewestRays = 16;
constexpr std::uint64_t kTrianglesPerRay = 256;

bool goes_in_lists(Lanes lanes, std::uint64_t triangles, std::size_t rays) {
  if (lanes != Lanes::kAuto) return lanes == Lanes::kRays;
  return rays >= kFewestRays && triangles <= kTrianglesPerRay * rays;
}

}  // namespace

void TreeletTraversal::test(Packet& packet, LocalRays& local, TestOutcome& outcome) {
  if (!treelets_.contains(packet.key)) return above_->test(packet, local, outcome);
  const accel::RayMembers members = context_.members(local.slots);
  // An engine's own tracer also counts the transforms.
  if (context_.subtree_tracer != nullptr)
    context_.subtree_tracer->trace(packet.key, members, outcome.counts);
  else if (goes_in_lists(lanes_, context_.accel.triangles_below(packet.key), members.count))
    accel::trace_stream(context_.accel, packet.key, members, outcome.counts);
  else
    accel::trace_interleaved(context_.accel, packet.key, members, outcome.counts);
  context_.any_hit.hold_back();
  for (const std::uint32_t slot : local.slots) context_.completion.add_pending(slot, -1);
}

}  // namespace carousel::ringbus
