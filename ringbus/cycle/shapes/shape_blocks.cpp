#include "ringbus/cycle/shapes/shape_blocks.h"

#include <algorithm>

namespace carousel::ringbus::cycle {

namespace {

/// The leaves that packets may name: not those that nodes hold.
std::vector<accel::NodeRef> leaves_of(const accel::Accel& accel) {
  std::vector<accel::NodeRef> out;
  const auto consider = [&](accel::NodeRef ref) {
    if (!ref.is_inner() && !ref.is_instance()) out.push_back(ref);
  };
  consider(accel.root_key().ref);
  for (const accel::InstanceNode& instance : accel.instances) consider(instance.root);
  for (std::uint32_t n = 0; n < accel.nodes.size(); ++n)
    for (int lane = 0; lane < accel.nodes[n].count; ++lane)
      if ((accel.nodes[n].direct >> lane & 1) == 0) consider(accel.nodes[n].child[lane]);
  return out;
}

}  // namespace

ShapeBlocks::ShapeBlocks(const accel::Accel& accel, const ShapeMemory& memory, std::uint64_t bytes)
    : of_node_(accel.nodes.size()), of_leaf_(accel.blocks.size()) {
  const auto strip = [&](accel::NodeRef ref) { return memory.strip({kNoInstance, ref}); };
  std::vector<accel::NodeRef> nodes, leaves = leaves_of(accel);
  for (std::uint32_t n = 0; n < accel.nodes.size(); ++n) nodes.push_back(accel::NodeRef::inner(n));
  std::sort(leaves.begin(), leaves.end(),
            [&](accel::NodeRef a, accel::NodeRef b) { return strip(a).address < strip(b).address; });
  for (const auto& strips : {nodes, leaves}) {
    bool first = true;
    for (const accel::NodeRef ref : strips) {
      const ShapeSpan span = strip(ref);
      if (first || blocks_.back().span.address / bytes != span.address / bytes)
        blocks_.push_back({ref, {span.address, 0}});
      first = false;
      ShapeSpan& whole = blocks_.back().span;
      whole.bytes = std::max(whole.bytes, static_cast<std::uint32_t>(span.address + span.bytes - whole.address));
      (ref.is_inner() ? of_node_[ref.node()] : of_leaf_[ref.first_block()]) =
          static_cast<std::uint32_t>(blocks_.size() - 1);
    }
  }
}

}  // namespace carousel::ringbus::cycle
