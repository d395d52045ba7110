#include "core/config/load/bound_rules.h"

#include <bit>
#include <string_view>

#include <fmt/format.h>

namespace carousel::config {

namespace {

class BoundRules {
 public:
  BoundRules(const Config& config, const RuleBreach& breach) : c(config), breach_(breach) {}

  void check() {
    elements_fit();
    if (c.cull_planes.count > 0) planes_need_bounded_errors();
    if (c.bundles.size > 0) bundles_fit();
    merged_meshes_fit();
    levels_fit();
  }

 private:
  void elements_fit() {
    if (c.bvh.elements == BvhConfig::Elements::kBoxes) return;
    if (c.bvh.elements == BvhConfig::Elements::kOrientedBoxes)
      need_bounded_errors("oriented boxes", "bvh.elements: boxes");
    constexpr std::string_view what = "{} need boxes to be tested with; expected boxes, or {}; found {}";
    const std::string_view found = enum_name(c.bvh.elements);
    if (c.cull_planes.count > 0)
      breach_("bvh.elements", fmt::format(what, "cull planes", "cull_planes.count: 0", found));
    if (c.bundles.size > 0) breach_("bvh.elements", fmt::format(what, "bundles", "bundles.size: 0", found));
  }

  // The top level's planes are fitted to instances.
  void merged_meshes_fit() {
    if (c.bvh.merge == BvhConfig::Merge::kNone || c.cull_planes.count == 0) return;
    if (c.cull_planes.levels != CullPlanesConfig::Levels::kBlas)
      breach_("cull_planes.levels",
              fmt::format("merged meshes hang in the top level, whose planes bound instances; expected blas, or "
                          "bvh.merge: none; found {}",
                          enum_name(c.cull_planes.levels)));
  }

  // Nodes of a group are tested with a slack of each ray's own (accel/structure/group_placement.h).
  void levels_fit() {
    if (c.bvh.levels == 2) return;
    constexpr std::string_view what = "{} not tested within groups of instances; expected 2, or {}; found {}";
    if (c.bundles.size > 0) breach_("bvh.levels", fmt::format(what, "bundles are", "bundles.size: 0", c.bvh.levels));
    if (c.bvh.elements != BvhConfig::Elements::kBoxes)
      breach_("bvh.levels",
              fmt::format(what, fmt::format("{} are", enum_name(c.bvh.elements)), "bvh.elements: boxes", c.bvh.levels));
    if (c.cull_planes.count > 0 && c.cull_planes.levels != CullPlanesConfig::Levels::kBlas)
      breach_("bvh.levels",
              fmt::format(what, "cull planes above the instances are", "cull_planes.levels: blas", c.bvh.levels));
  }

  // A bundle has one owner, which tests all of its rays at one visit.
  void bundles_fit() {
    const BundlesConfig& b = c.bundles;
    if (b.size == 1) breach_("bundles.size", "expected 2 rays or more, or 0 for none; found 1");
    if (b.size > c.rays.slots_per_resource)
      breach_("bundles.size",
              fmt::format("a bundle's rays live in one resource; expected at most rays.slots_per_resource = "
                          "{}, found {}",
                          c.rays.slots_per_resource, b.size));
    if (b.strict && b.order == BundlesConfig::Order::kAnyHitOnly)
      breach_("bundles.strict",
              "any_hit_only takes bundles along where only some of their rays hit; expected false, found true");
    constexpr std::string_view without = ", or bundles.size: 0";
    if (c.collections.traversal == Traversal::kOrdered)
      breach_("collections.traversal",
              fmt::format("rays of a bundle go several ways at once; expected spread or treelet, found ordered{}",
                          without));
    if (c.packets.shapes == PacketShapes::kSingle)
      breach_("packets.shapes",
              fmt::format("a bundle is tested against a whole strip; expected strip, found single{}", without));
    if (c.rays.placement == Placement::kFirstTaker || c.rays.placement == Placement::kAddressed)
      breach_("rays.placement",
              fmt::format("bundles are made before their rays have slots; expected balanced or round_robin, "
                          "found {}{}",
                          enum_name(c.rays.placement), without));
    if (!properties_of(c.topology).has_packets) {
      const bool drawn = c.topology.shape == TopologyShape::kGraph;
      breach_(drawn ? "topology.trace" : "topology.shape",
              fmt::format("independent resources trace single rays; expected {}, found {}{}",
                          drawn ? "packets" : "a ring or another network", drawn ? "stacks" : "independent", without));
    }
    if (std::bit_width(static_cast<std::uint64_t>(c.topology.resources - 1)) +
            std::bit_width(static_cast<std::uint64_t>(2 * c.rays.slots_per_resource)) >
        32)
      breach_("rays.slots_per_resource",
              fmt::format("IDs of 32 bits name bundles as well; expected fewer slots than {}{}",
                          c.rays.slots_per_resource, without));
  }

  // The slack of their tests covers the rounding of these kernels. For the others there is no bound.
  void need_bounded_errors(std::string_view objects, std::string_view without) {
    if (c.accuracy.triangle != TriangleLevel::kWatertight && c.accuracy.triangle != TriangleLevel::kExact)
      breach_("accuracy.triangle", fmt::format("{} could lose hits of {}; expected watertight or exact, or {}", objects,
                                               enum_name(c.accuracy.triangle), without));
    if (c.accuracy.box != BoxLevel::kConservative)
      breach_("accuracy.box", fmt::format("{} go with conservative boxes; expected conservative, found {}, or {}",
                                          objects, enum_name(c.accuracy.box), without));
  }

  void planes_need_bounded_errors() {
    need_bounded_errors("cull planes", "cull_planes.count: 0");
    if (c.cull_planes.levels != CullPlanesConfig::Levels::kBlas &&
        c.accuracy.transform == TransformLevel::kInverseMatrix)
      breach_("accuracy.transform",
              fmt::format("cull planes above the instances could lose hits of {}; expected two_step, "
                          "two_step_double or transpose_if_rotation, or cull_planes.levels: blas",
                          enum_name(c.accuracy.transform)));
    if (c.cull_planes.object == CullPlanesConfig::Object::kOrientedBox) {
      if (c.cull_planes.count < 6)
        breach_(
            "cull_planes.count",
            fmt::format("an oriented box has six faces; expected 6 or more, found {}, or cull_planes.object: planes",
                        c.cull_planes.count));
      if (c.cull_planes.shared_normals)
        breach_("cull_planes.shared_normals",
                "each oriented box has axes of its own; expected false, found true, or cull_planes.object: planes");
    }
    if (c.cull_planes.object == CullPlanesConfig::Object::kSphere) {
      constexpr std::string_view without = ", or cull_planes.object: planes";
      if (c.cull_planes.shared_normals)
        breach_("cull_planes.shared_normals",
                fmt::format("a sphere has no normal; expected false, found true{}", without));
      if (c.cull_planes.levels != CullPlanesConfig::Levels::kBlas)
        breach_("cull_planes.levels", fmt::format("spheres stand below the instances; expected blas, found {}{}",
                                                  enum_name(c.cull_planes.levels), without));
    }
    if (c.cull_planes.depth.first > c.cull_planes.depth.last)
      breach_("cull_planes.depth.first",
              fmt::format("no node has such a depth; expected at most cull_planes.depth.last = {}, found {}",
                          c.cull_planes.depth.last, c.cull_planes.depth.first));
  }

  const Config& c;
  const RuleBreach& breach_;
};

}  // namespace

void check_bounds(const Config& config, const RuleBreach& breach) {
  BoundRules(config, breach).check();
}

}  // namespace carousel::config
