#pragma once

#include <cstdint>
#include <vector>

#include "core/config/fields/collections.h"
#include "ringbus/resource/traversal/traversal_method.h"
#include "ringbus/resource/visit/piece_walk.h"
#include "ringbus/resource/visit/visit_context.h"

namespace carousel::ringbus {

/// `bvh.treelets`: the whole tree is cut into pieces (accel::TreePieces), and a collection is a piece's. A visit takes
/// its rays through the piece, each by itself and depth first; they enter it at its root, and leave it for the roots of
/// other pieces (T. Aila, T. Karras, Architecture Considerations for Tracing Incoherent Rays, HPG 2010).
///
/// With `all_at_once` (`traversal: spread` or `treelet`) a ray joins the collections of all of these that its visit
/// leaves before the hit that it has by then. It waits for one test a piece, and its packet lists where it goes. A
/// packet's retirement takes at most a block for each way out of its piece.
///
/// Otherwise (`ordered`) it joins that of the nearest, or with `order: stored` of the first it met, and the others wait
/// on a stack beside its record, which is read and written through the store's port, 64 bytes an access. It waits for
/// one test until it has no piece left, and a packet's retirement may take a block for each of its rays.
class PieceTraversal final : public TraversalMethod {
 public:
  /// Keeps references. The tree is cut.
  PieceTraversal(const VisitContext& context, ChildOrder order, bool all_at_once)
      : context_(context),
        order_(order),
        all_at_once_(all_at_once),
        walk_(context.accel, order),
        stacks_(all_at_once ? 0 : context.store.slots()) {}

  std::int32_t tests_at(accel::NodeKey) const override { return 1; }
  std::uint32_t lanes(std::uint32_t) const override { return ~0u; }
  std::uint32_t blocks_needed(accel::NodeKey key, std::uint32_t rays) const override {
    return all_at_once_ ? context_.accel.pieces->piece(key.ref).exits : rays;
  }
  bool is_treelet(accel::NodeKey) const override { return true; }
  void prepare(Packet& packet) const override;
  void test(Packet& packet, LocalRays& local, TestOutcome& outcome) override;
  void retire(const Packet& packet, CollectionStore& collections) override;
  void discard() override;

 private:
  /// Bytes of an entry of a ray's stack: a node's key, and where the ray enters it.
  static constexpr std::uint64_t kEntryBytes = 12, kAccessBytes = 64;

  void go_on_at_all(std::uint32_t slot, std::uint32_t member, Packet& packet);
  void go_on_at_one(std::uint32_t slot, std::uint32_t member, Packet& packet, TestOutcome& outcome);

  const VisitContext context_;
  ChildOrder order_;
  bool all_at_once_;
  PieceWalk walk_;
  std::vector<std::vector<NextNode>> stacks_;  // by slot: the pieces that an ordered ray has yet to visit, next on top
  // Scratch of a visit.
  std::vector<accel::NodeKey> from_;
  std::vector<NextNode> nodes_;
  std::vector<PacketExit> exits_;
  std::vector<NextNode> left_;  // ways out of one ray
};

}  // namespace carousel::ringbus
