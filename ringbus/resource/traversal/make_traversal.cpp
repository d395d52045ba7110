#include "ringbus/resource/traversal/make_traversal.h"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "core/config/fields/collections.h"
#include "core/config/fields/packets.h"
#include "core/types/enum_names.h"
#include "ringbus/resource/traversal/bundled.h"
#include "ringbus/resource/traversal/ordered.h"
#include "ringbus/resource/traversal/pieces.h"
#include "ringbus/resource/traversal/single_shape.h"
#include "ringbus/resource/traversal/spread.h"
#include "ringbus/resource/traversal/treelet.h"

namespace carousel::ringbus {

namespace {

using Method = std::unique_ptr<TraversalMethod>;

Treelets treelets_of(const TraversalSettings& settings, const accel::Accel& accel) {
  std::optional<std::uint64_t> most_triangles;
  if (settings.traversal == Traversal::kTreelet)
    most_triangles = static_cast<std::uint64_t>(settings.treelet_triangles);
  return {accel, most_triangles};
}

Method make_spread(const TraversalSettings& settings, const VisitContext& context) {
  if (settings.shapes == PacketShapes::kSingle)
    return std::make_unique<SingleShapeTraversal>(context, treelets_of(settings, context.accel), settings.made_per);
  return std::make_unique<SpreadTraversal>(context);
}

Method make_ordered(const TraversalSettings& settings, const VisitContext& context) {
  return std::make_unique<OrderedTraversal>(context, settings.order);
}

Method make_treelet(const TraversalSettings& settings, const VisitContext& context) {
  return std::make_unique<TreeletTraversal>(context, treelets_of(settings, context.accel),
                                            make_spread(settings, context), settings.lanes);
}

struct Row {
  Traversal traversal;
  bool one_collection_a_ray;
  Method (*make)(const TraversalSettings& settings, const VisitContext& context);
};

// A new traversal has three places: its class in a file of this folder, its row here, and its value and name in
// core/config/fields/collections.h. Values of other keys that it cannot be combined with are refused in core/config.
constexpr std::array kTraversals{
    Row{Traversal::kSpread, false, make_spread},
    Row{Traversal::kOrdered, true, make_ordered},
    Row{Traversal::kTreelet, false, make_treelet},
};
static_assert(kTraversals.size() == kEnumNames<Traversal>.size(), "a row for each traversal");

const Row& row_of(Traversal traversal) {
  return *std::find_if(kTraversals.begin(), kTraversals.end(),
                       [&](const Row& row) { return row.traversal == traversal; });
}

}  // namespace

std::unique_ptr<TraversalMethod> make_traversal(const TraversalSettings& settings, const VisitContext& context) {
  if (settings.treelets)
    return std::make_unique<PieceTraversal>(context, settings.order, !one_collection_a_ray(settings.traversal));
  Method method = row_of(settings.traversal).make(settings, context);
  if (settings.bundles.size == 0) return method;
  return std::make_unique<BundledTraversal>(settings.bundles, settings.scene_size, context, std::move(method));
}

std::int32_t initial_tests(const TraversalSettings& settings, const accel::Accel& accel) {
  if (settings.shapes == PacketShapes::kStrip) return 1;
  return SingleShapeTraversal::tests_at(accel, treelets_of(settings, accel), accel.root_key());
}

std::int32_t initial_collections(const TraversalSettings& settings, const accel::Accel& accel) {
  return settings.made_per == MadePer::kChild ? initial_tests(settings, accel) : 1;
}

bool one_collection_a_ray(Traversal traversal) {
  return row_of(traversal).one_collection_a_ray;
}

}  // namespace carousel::ringbus
