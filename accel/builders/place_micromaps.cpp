#include "accel/builders/place_micromaps.h"

#include <unordered_set>
#include <vector>

namespace carousel::accel {

namespace {

/// Fills in the bytes of the structures below instances, each once.
class MicromapWalk {
 public:
  MicromapWalk(const Accel& accel, const scene::OpacityMicromaps& maps)
      : accel_(accel), maps_(maps), bytes_(accel.blocks.size() * kBlockTriangles) {}

  void below(std::uint32_t instance) {
    const NodeRef root = accel_.instances[instance].root;
    if (!seen_.insert(root.bits()).second) return;
    const bool merged = accel_.merged.holds(instance);
    std::vector<NodeRef> open{root};
    while (!open.empty()) {
      const NodeRef ref = open.back();
      open.pop_back();
      if (ref.is_inner()) {
        const Node& node = accel_.nodes[ref.node()];
        open.insert(open.end(), node.child, node.child + node.count);
      } else if (ref.kind() == NodeRef::Kind::kLeaf) {
        for (std::uint32_t b = 0; b < ref.blocks(); ++b) fill(instance, merged, ref.first_block() + b);
      }
    }
  }
  MicromapPlaces places() const { return MicromapPlaces(bytes_); }

 private:
  void fill(std::uint32_t instance, bool merged, std::uint32_t block) {
    for (std::uint32_t lane = 0; lane < kBlockTriangles; ++lane) {
      const std::uint32_t primitive = accel_.blocks[block].primitive[lane];
      if (primitive == kNoPrimitive || (primitive & kNonOpaqueBit) == 0) continue;
      MergedMeshes::Name name{instance, primitive & kPrimitiveMask};
      if (merged) name = accel_.merged.name(name.primitive);
      bytes_[std::size_t{block} * kBlockTriangles + lane] =
          maps_.bytes_of(maps_.mesh_of[name.instance], name.primitive);
    }
  }

  const Accel& accel_;
  const scene::OpacityMicromaps& maps_;
  std::vector<std::uint32_t> bytes_;
  std::unordered_set<std::uint32_t> seen_;  // roots
};

}  // namespace

void set_micromaps(Accel& accel, const scene::OpacityMicromaps& maps) {
  MicromapWalk walk(accel, maps);
  for (std::uint32_t i = 0; i < maps.mesh_of.size(); ++i)
    if (!accel.merged.holds(i) || i == accel.merged.instance()) walk.below(i);
  accel.micromaps = {&maps, walk.places()};
}

}  // namespace carousel::accel
