#pragma once

#include "core/config/fields/packets.h"
#include "ringbus/resource/traversal/spread.h"
#include "ringbus/resource/traversal/treelets.h"

namespace carousel::ringbus {

/// `packets.shapes: single`: as SpreadTraversal, but a packet tests one shape of a strip.
///
/// A ray waits for as many tests at a node as its strip has shapes. Its owner sees one shape a visit, so it must count
/// shapes: counting nodes would complete nearly every ray early (docs/how-it-works/design.md, The way of a ray). A
/// packet's retirement takes at most one block. With `made_per: child` each shape has a collection of its own, and rays
/// that hit its parent join it (US 9633468: packets "per child node", as against collections of rays that have hit a
/// node).
class SingleShapeTraversal final : public SpreadTraversal {
 public:
  SingleShapeTraversal(const VisitContext& context, const Treelets& treelets, MadePer made_per)
      : SpreadTraversal(context), treelets_(treelets), per_child_(made_per == MadePer::kChild) {}

  /// A treelet is one test. The root of an empty scene has no shapes, but its packet must come round all the same.
  static std::int32_t tests_at(const accel::Accel& accel, const Treelets& treelets, accel::NodeKey key);

  std::int32_t tests_at(accel::NodeKey key) const override { return tests_at(context_.accel, treelets_, key); }
  std::int32_t collections_at(accel::NodeKey key) const override { return per_child_ ? tests_at(key) : 1; }
  std::uint32_t lanes(std::uint32_t n) const override { return 1u << n; }
  std::uint32_t blocks_needed(accel::NodeKey key, std::uint32_t rays) const override;

 private:
  void answer(Packet& packet, const LocalRays& local, const std::vector<std::uint8_t>& masks) override;

  std::int32_t collections_below(accel::NodeKey key, int lane) const override {
    return per_child_ ? tests_below(key, lane) : 1;
  }
  std::int32_t tests_below(accel::NodeKey key, int lane) const;

  Treelets treelets_;
  bool per_child_;
};

}  // namespace carousel::ringbus
