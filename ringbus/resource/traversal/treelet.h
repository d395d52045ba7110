#pragma once

#include <memory>

#include "core/config/fields/engine.h"
#include "ringbus/resource/traversal/traversal_method.h"
#include "ringbus/resource/traversal/treelets.h"
#include "ringbus/resource/visit/visit_context.h"

namespace carousel::ringbus {

/// `traversal: treelet`: a packet may name a whole subtree, which the rays' owner takes them through in one visit;
/// above the treelets rays go down as by another method.
///
/// A treelet is one test, after which the ray has nothing to wait for there. Its retirement takes no block.
class TreeletTraversal final : public TraversalMethod {
 public:
  TreeletTraversal(const VisitContext& context, const Treelets& treelets, std::unique_ptr<TraversalMethod> above,
                   Lanes lanes)
      : context_(context), treelets_(treelets), above_(std::move(above)), lanes_(lanes) {}

  std::int32_t tests_at(accel::NodeKey key) const override {
    return treelets_.contains(key) ? 1 : above_->tests_at(key);
  }
  std::int32_t collections_at(accel::NodeKey key) const override {
    return treelets_.contains(key) ? 1 : above_->collections_at(key);
  }
  std::uint32_t lanes(std::uint32_t n) const override { return above_->lanes(n); }
  std::uint32_t blocks_needed(accel::NodeKey key, std::uint32_t rays) const override {
    return treelets_.contains(key) ? 0 : above_->blocks_needed(key, rays);
  }
  bool is_treelet(accel::NodeKey key) const override { return treelets_.contains(key); }
  void test(Packet& packet, LocalRays& local, TestOutcome& outcome) override;
  void retire(const Packet& packet, CollectionStore& collections) override {
    if (!treelets_.contains(packet.key)) above_->retire(packet, collections);
  }

 private:
  const VisitContext context_;
  Treelets treelets_;
  std::unique_ptr<TraversalMethod> above_;
  Lanes lanes_;
};

}  // namespace carousel::ringbus
