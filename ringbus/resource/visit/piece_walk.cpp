#include "ringbus/resource/visit/piece_walk.h"

#include <algorithm>

#include "accel/traverse/kernels.h"
#include "ringbus/resource/visit/last_first.h"

namespace carousel::ringbus {

void PieceWalk::trace(accel::NodeKey from, const accel::RayMembers& members, IntersectionCounts& counts) {
  accel::trace_interleaved(accel_, from, members, counts);
}

void PieceWalk::trace_treelets(std::span<const accel::NodeKey> from, const accel::RayMembers& members,
                               std::vector<PacketExit>& exits, IntersectionCounts& counts) {
  for (std::uint32_t i = 0; i < members.count; ++i) {
    const accel::RayMembers ray{members.records, members.slots + i, 1, members.culls, members.any_hit_calls};
    const RayRecord& record = members.records[*ray.slots];
    bool first = true;
    stack_.assign(1, {from[i], 0, 0, true});
    while (!stack_.empty() && (record.tag.flags & kRayDone) == 0) {
      const NextNode at = stack_.back();
      stack_.pop_back();
      if (at.entry > record.hit.t) continue;
      std::uint8_t mask = 0;
      float nearest[accel::kMaxWidth], entry[accel::kMaxWidth];
      std::fill(std::begin(nearest), std::end(nearest), kInfinity);
      IntersectionCounts tests;
      accel::test_strip(accel_, at.key, ~0u, ray, {&mask, nearest, entry}, tests);
      // A piece lies within one structure, so that a ray is transformed once.
      if (!first) tests.transforms = tests.transforms_in_double = 0;
      first = false;
      counts += tests;
      if (!at.key.ref.is_inner()) continue;
      const accel::Node& node = accel_.nodes[at.key.ref.node()];
      const auto met = static_cast<std::ptrdiff_t>(exits.size());
      last_first(order_, mask, entry, [&](int lane) {
        const NextNode next{accel_.child_key(at.key, lane), entry[lane], static_cast<std::uint16_t>(at.depth + 1),
                            true};
        if (accel_.pieces->together(at.key.ref, node.child[lane]))
          stack_.push_back(next);
        else
          exits.push_back({i, next});
      });
      std::reverse(exits.begin() + met, exits.end());
    }
  }
}

}  // namespace carousel::ringbus
