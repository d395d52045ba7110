#pragma once

#include <cstdint>
#include <memory>

#include "accel/structure/accel.h"
#include "core/config/fields/bundles.h"
#include "core/config/fields/collections.h"
#include "core/config/fields/engine.h"
#include "core/config/fields/packets.h"

namespace carousel::ringbus {

class TraversalMethod;
struct VisitContext;

/// The parts of the configuration that decide how rays go down the tree.
struct TraversalSettings {
  Traversal traversal = Traversal::kSpread;
  ChildOrder order = ChildOrder::kNearest;
  PacketShapes shapes = PacketShapes::kStrip;
  MadePer made_per = MadePer::kParent;
  BundlesConfig bundles;
  std::int64_t treelet_triangles = 2048;
  float scene_size = 1;
  bool treelets = false;
  Lanes lanes = Lanes::kAuto;
};

std::unique_ptr<TraversalMethod> make_traversal(const TraversalSettings& settings, const VisitContext& context);

/// Tests that a new ray waits for at the root, as TraversalMethod::tests_at() would say.
std::int32_t initial_tests(const TraversalSettings& settings, const accel::Accel& accel);

/// Collections that it joins there, as TraversalMethod::collections_at() would say.
std::int32_t initial_collections(const TraversalSettings& settings, const accel::Accel& accel);

/// True if a ray is in one collection at a time: then packets carry each ray's next node (Packet::next), and storage
/// is bounded by a block a ray. Otherwise a ray joins the collections of all children that it hits.
bool one_collection_a_ray(Traversal traversal);

}  // namespace carousel::ringbus
