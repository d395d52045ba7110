#include "accel/builders/binary/reference_build.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "accel/builders/binary/space_bins.h"

namespace carousel::accel {

namespace {

using References = BuildPrimitives;

constexpr int kLeastCell = 3 * 20;  // divisions of an octree's cube in a row that separate nothing
// Boxes of siblings that overlap by no more than this part of the root's area are not worth a plane (Stich 2009, 4.5).
constexpr float kLeastOverlap = 1e-5f;

Aabb bounds_of(const References& references) {
  Aabb box;
  for (const BuildPrimitive& p : references) box.extend(box_of(p));
  return box;
}

Aabb joined(Aabb box, const BuildPrimitive& p) {
  box.extend(box_of(p));
  return box;
}

class ReferenceBuilder {
 public:
  using Kind = BvhConfig::Builder;

  ReferenceBuilder(const SahSettings& settings, Kind builder) : settings_(settings), builder_(builder) {}

  BinaryTree run(References& primitives, double duplicates) {
    const double cuts = std::floor(duplicates * static_cast<double>(primitives.size()));
    root_area_ = bounds_of(primitives).half_area();
    Cell cell{bounds_of(primitives), 0};
    const Vec3 extent = cell.box.extent();
    const float side = std::max({extent.x, extent.y, extent.z});
    for (int axis = 0; axis < 3; ++axis) cell.box.hi[axis] = cell.box.lo[axis] + side;
    build(std::move(primitives), cell, static_cast<std::size_t>(cuts), 0);
    primitives = std::move(leaves_);
    return std::move(nodes_);
  }

 private:
  /// A cell of an octree, which is divided at its middle across the axis `turn` modulo 3.
  struct Cell {
    Aabb box;
    int turn;
    SpacePlane middle() const {
      const int axis = turn % 3;
      return {axis, box.lo[axis] * 0.5f + box.hi[axis] * 0.5f};
    }
    Cell half(bool above) const {
      const SpacePlane s = middle();
      Cell out{box, turn + 1};
      (above ? out.box.lo : out.box.hi)[s.axis] = s.at;
      return out;
    }
  };
  struct Parts {
    References below, above;
  };

  float blocks(std::size_t n) const {
    const std::size_t full_or_not = (n + settings_.block_primitives - 1) / settings_.block_primitives;
    return static_cast<float>(full_or_not);
  }

  static Parts by_centroid(const References& references, SpacePlane s) {
    Parts out;
    for (const BuildPrimitive& p : references) (centroid(p, s.axis) < s.at ? out.below : out.above).push_back(p);
    return out;
  }
  static Parts by_halves(const References& references) {
    const auto middle = references.begin() + static_cast<std::ptrdiff_t>(references.size() / 2);
    return {{references.begin(), middle}, {middle, references.end()}};
  }

  static void cut(const BuildPrimitive& p, SpacePlane s, Parts& out) {
    BuildPrimitive part = p;
    part.hi[s.axis] = s.at;
    out.below.push_back(part);
    part = p;
    part.lo[s.axis] = s.at;
    out.above.push_back(part);
  }

  /// With `keep` given, a reference on both sides stays whole on one of them if that costs less (Stich 2009, 4.4).
  Parts by_space(const References& references, SpacePlane s, const Sides* keep) const {
    Parts out;
    Sides sides = keep != nullptr ? *keep : Sides{};
    for (const BuildPrimitive& p : references) {
      const bool below = lies_below(p, s), above = lies_above(p, s);
      if (below && above) {
        const int side = keep != nullptr ? whole_on(p, sides) : 0;
        if (side == 0) cut(p, s, out);
        if (side < 0) out.below.push_back(p);
        if (side > 0) out.above.push_back(p);
      } else {
        (below ? out.below : out.above).push_back(p);
      }
    }
    return out;
  }

  /// -1 if a reference on both sides had better stay whole below, 1 if above, 0 if it is cut; `sides` are then those
  /// without its other part.
  int whole_on(const BuildPrimitive& p, Sides& sides) const {
    const Aabb below = joined(sides.below, p), above = joined(sides.above, p);
    const float area_below = sides.below.half_area(), area_above = sides.above.half_area();
    const float cut = area_below * blocks(sides.count_below) + area_above * blocks(sides.count_above);
    const float all_below = below.half_area() * blocks(sides.count_below) + area_above * blocks(sides.count_above - 1);
    const float all_above = area_below * blocks(sides.count_below - 1) + above.half_area() * blocks(sides.count_above);
    if (all_below < cut && all_below <= all_above && sides.count_above > 1) {
      sides.below = below;
      --sides.count_above;
      return -1;
    }
    if (all_above < cut && sides.count_below > 1) {
      sides.above = above;
      --sides.count_below;
      return 1;
    }
    return 0;
  }

  bool overlaps(const Division& split) const {
    const auto& [below, above] = std::pair(split.sides.below, split.sides.above);
    Aabb both;
    for (int axis = 0; axis < 3; ++axis) {
      both.lo[axis] = std::max(below.lo[axis], above.lo[axis]);
      both.hi[axis] = std::min(below.hi[axis], above.hi[axis]);
    }
    return both.half_area() > kLeastOverlap * root_area_;
  }

  /// Divides the cell of an octree until a plane leaves fewer on both sides, no more than `cuts` of them cut.
  bool octree_parts(const References& references, Cell& cell, std::size_t cuts, Parts& out) const {
    int idle = 0;  // axes in a row that could be divided and were not
    for (int tries = 0; tries < kLeastCell && idle < 3; ++tries) {
      const SpacePlane s = cell.middle();
      Sides sides;
      for (const BuildPrimitive& p : references) {
        sides.count_below += lies_below(p, s);
        sides.count_above += lies_above(p, s);
      }
      if (sides.helps(references.size()) && sides.cuts(references.size()) <= cuts) {
        out = by_space(references, s, nullptr);
        return true;
      }
      if (sides.cuts(references.size()) == 0) {
        cell = cell.half(sides.count_below == 0);  // one half is empty
        idle = 0;
      } else {
        ++cell.turn;
        ++idle;
      }
    }
    return false;
  }

  std::uint32_t leaf(References references, std::uint32_t at) {
    nodes_[at].first = static_cast<std::uint32_t>(leaves_.size());
    nodes_[at].count = static_cast<std::uint32_t>(references.size());
    leaves_.insert(leaves_.end(), references.begin(), references.end());
    return at;
  }

  /// The node of `references`, which planes may cut `cuts` times.
  std::uint32_t build(References references, Cell cell, std::size_t cuts, int depth) {
    const auto at = static_cast<std::uint32_t>(nodes_.size());
    const std::size_t count = references.size();
    nodes_.emplace_back(BinaryNode{}).box = bounds_of(references);
    const Aabb box = nodes_[at].box;
    if (count == 1 || (count <= settings_.leaf_primitives && count <= settings_.block_primitives))
      return leaf(std::move(references), at);

    Division object, space;
    if (depth < kSahDepth) {
      const auto blocks_of = [this](std::size_t n) { return blocks(n); };
      object = best_object_division(references, blocks_of);
      if (builder_ == Kind::kKd || (builder_ == Kind::kSpatial && cuts > 0 && (!object.found() || overlaps(object))))
        space = best_space_division(references, box, cuts, blocks_of);
    }
    const bool by_plane = builder_ == Kind::kSpatial ? space.sides.cost < object.sides.cost : space.found();

    const float cost = by_plane ? space.sides.cost : object.sides.cost, area = box.half_area();
    if (count <= settings_.leaf_primitives && !(cost + settings_.traversal_cost * area < area * blocks(count)))
      return leaf(std::move(references), at);

    Parts parts;
    Cell cells[2] = {cell, cell};
    if (builder_ == Kind::kOctree && depth < kSahDepth && octree_parts(references, cell, cuts, parts)) {
      cells[0] = cell.half(false);
      cells[1] = cell.half(true);
    } else if (by_plane) {
      parts = by_space(references, space.plane, builder_ == Kind::kSpatial ? &space.sides : nullptr);
    } else if (object.found()) {
      parts = by_centroid(references, object.plane);
    } else {
      parts = by_halves(references);
    }
    References().swap(references);
    const std::size_t total = parts.below.size() + parts.above.size();
    cuts -= total - count;
    const std::size_t cuts_below = static_cast<std::size_t>(
        static_cast<double>(cuts) * static_cast<double>(parts.below.size()) / static_cast<double>(total));
    const std::size_t cuts_above = cuts - std::min(cuts, cuts_below);
    const std::uint32_t left = build(std::move(parts.below), cells[0], cuts - cuts_above, depth + 1);
    const std::uint32_t right = build(std::move(parts.above), cells[1], cuts_above, depth + 1);
    nodes_[at].first = left;
    nodes_[at].right = right;
    return at;
  }

  const SahSettings& settings_;
  const Kind builder_;
  float root_area_ = 0;
  BinaryTree nodes_;
  References leaves_;
};

}  // namespace

BinaryTree build_references(BuildPrimitives& primitives, const SahSettings& settings, BvhConfig::Builder builder,
                            double duplicates) {
  return ReferenceBuilder(settings, builder).run(primitives, duplicates);
}

}  // namespace carousel::accel
