#include "accel/builders/group_levels.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

#include <glm/matrix.hpp>

#include "accel/builders/binary/sah_build.h"
#include "accel/builders/level_plan.h"
#include "accel/builders/mesh/wide_collapse.h"
#include "core/numeric/rounding.h"

namespace carousel::accel {

namespace {

constexpr float kLargestBound = std::numeric_limits<float>::max();

/// A map in double.
struct Map {
  DMat3 linear;
  DVec3 translation;

  explicit Map(const scene::Affine& m) : linear(m.linear), translation(m.translation) {}
};

/// The box around `box` as it stands in a group: the exact one but for a few roundings of doubles, and then outwards.
Aabb box_in_group(const Map& group, const Map& placed, const Aabb& box) {
  const DMat3 inverse = glm::inverse(group.linear), linear = inverse * placed.linear;
  const DVec3 offset = placed.translation - group.translation, translation = inverse * offset;
  Aabb out;
  for (int row = 0; row < 3; ++row) {
    double lo = translation[row], hi = lo, terms = 0;
    for (int c = 0; c < 3; ++c) {
      const double a = linear[c][row] * box.lo[c], b = linear[c][row] * box.hi[c];
      lo += std::fmin(a, b);
      hi += std::fmax(a, b);
      const double largest = std::fmax(std::fabs(double(box.lo[c])), std::fabs(double(box.hi[c])));
      for (int k = 0; k < 3; ++k) terms += std::fabs(inverse[k][row] * placed.linear[c][k]) * largest;
      terms += std::fabs(inverse[c][row] * offset[c]);
    }
    const double pad = 0x1p-48 * terms;  // about ten roundings
    out.lo[row] = std::max(-kLargestBound, std::nextafter(static_cast<float>(lo - pad), -INFINITY));
    out.hi[row] = std::min(kLargestBound, std::nextafter(static_cast<float>(hi + pad), INFINITY));
  }
  return out;
}

/// The largest sum of a row of |A| |B|.
double largest_row(const DMat3& a, const DMat3& b) {
  double most = 0;
  for (int row = 0; row < 3; ++row) {
    double sum = 0;
    for (int k = 0; k < 3; ++k)
      for (int c = 0; c < 3; ++c) sum += std::fabs(a[k][row]) * std::fabs(b[c][k]);
    most = std::max(most, sum);
  }
  return most;
}

class GroupLevels {
 public:
  GroupLevels(const scene::Scene& scene, const BvhConfig& config, const std::function<PlacedBox(std::uint32_t)>& box_of,
              Executor& executor, Accel& accel)
      : scene_(scene),
        box_of_(box_of),
        executor_(executor),
        accel_(accel),
        plan_(scene, static_cast<int>(config.levels) - 2, accel.accuracy.transform),
        own_(accel.instances.size()) {}

  TopMembers run() {
    TopMembers top;
    for (const LevelPlan::Member& member : plan_.top()) top.instances.push_back(entry_of(member));
    // Members that are groups get their entries after all that are there; these have their members found in turn.
    for (std::size_t k = 0; k < levels_.size(); ++k) {
      accel_.groups[k].first_member = static_cast<std::uint32_t>(accel_.members.size());
      const std::vector<LevelPlan::Member> members = plan_.members(levels_[k]);
      by_structure_[{levels_[k].room, levels_[k].group}].placements.push_back(k);
      by_structure_[{levels_[k].room, levels_[k].group}].count = members.size();
      for (const LevelPlan::Member& member : members) {
        const std::uint32_t entry = entry_of(member);
        accel_.instances[entry].member = true;
        accel_.members.push_back(entry);
      }
    }
    // In the order of their room: what is in a group has less.
    for (auto& [key, structure] : by_structure_) {
      build(structure);
      top.groups_depth = std::max(top.groups_depth, structure.depth);
    }
    return top;
  }

 private:
  /// One group's structure, of all its placements.
  struct Structure {
    std::vector<std::size_t> placements;  // in Accel::groups
    std::size_t count = 0;                // members
    Aabb box;
    int depth = 0;  // with the groups in it
  };
  /// The values that decide the slack of a group's tests, over everything below a placement.
  struct Below {
    double largest_row = 1;
    Aabb translations;
  };

  std::uint32_t entry_of(const LevelPlan::Member& member) {
    if (!member.level) return member.instance;
    const auto entry = static_cast<std::uint32_t>(accel_.instances.size());
    InstanceNode& node = accel_.instances.emplace_back();
    const scene::Affine& m = scene_.placements[member.level->placement].world_from_group;
    make_transform(m, node.transform, accel_.accuracy.transform);
    node.group = true;
    accel_.groups.emplace_back().placement = member.level->placement;
    levels_.push_back(*member.level);
    below_.emplace_back();
    return entry;
  }
  bool is_group(std::uint32_t entry) const { return entry >= own_; }
  const Structure& structure_of(std::uint32_t entry) const {
    const LevelPlan::Level& level = levels_[entry - own_];
    return by_structure_.at({level.room, level.group});
  }
  PlacedBox placed_box(std::uint32_t entry) const {
    if (!is_group(entry)) return box_of_(entry);
    return {structure_of(entry).box, scene_.placements[levels_[entry - own_].placement].world_from_group};
  }

  void build(Structure& structure) {
    BuildPrimitives primitives(structure.count);
    std::vector<Aabb> boxes(structure.count);
    // Composed transforms are rounded: a member stands not quite in the same place in all placements.
    for (const std::size_t k : structure.placements) {
      const Map group(scene_.placements[levels_[k].placement].world_from_group);
      for (std::size_t m = 0; m < structure.count; ++m) {
        const PlacedBox placed = placed_box(accel_.members[accel_.groups[k].first_member + m]);
        boxes[m].extend(box_in_group(group, Map(placed.world_from_box), placed.box));
      }
    }
    for (std::size_t m = 0; m < structure.count; ++m) {
      structure.box.extend(boxes[m]);
      primitives[m].lo = boxes[m].lo;
      primitives[m].hi = boxes[m].hi;
      primitives[m].index = static_cast<std::uint32_t>(m);
    }
    const std::uint32_t* const any_members = &accel_.members[accel_.groups[structure.placements.front()].first_member];
    const BinaryTree binary = build_sah(primitives, {.leaf_primitives = 1, .block_primitives = 1}, executor_);
    const auto make_leaf = [&](const BinaryNode& leaf, std::uint32_t) {
      const std::uint32_t m = primitives[leaf.first].index;
      const InstanceNode& node = accel_.instances[any_members[m]];
      return WideLeaf{NodeRef::instance(m), node.strip_size, node.triangles};
    };
    const WideTree tree = collapse(binary, accel_.width, make_leaf, executor_, accel_.nodes);
    for (std::size_t m = 0; m < structure.count; ++m)
      if (is_group(any_members[m])) structure.depth = std::max(structure.depth, structure_of(any_members[m]).depth);
    structure.depth += tree.depth;
    for (const std::size_t k : structure.placements) finish(k, tree, structure.count);
  }

  void finish(std::size_t k, const WideTree& tree, std::size_t count) {
    InstanceNode& node = accel_.instances[own_ + k];
    node.root = tree.root;
    node.strip_size = tree.root_strip_size;
    node.triangles = tree.triangles;
    Below& below = below_[k];
    const auto add = [&](const scene::Affine& m) {
      below.largest_row = std::max(below.largest_row, largest_row(DMat3(m.linear), glm::inverse(DMat3(m.linear))));
      below.translations.extend(m.translation);
    };
    GroupPlacement& placement = accel_.groups[k];
    const scene::Affine& own = scene_.placements[placement.placement].world_from_group;
    add(own);
    for (std::size_t m = 0; m < count; ++m) {
      const std::uint32_t entry = accel_.members[placement.first_member + m];
      const InstanceNode& member = accel_.instances[entry];
      node.world.extend(member.world);
      if (is_group(entry)) {
        below.largest_row = std::max(below.largest_row, below_[entry - own_].largest_row);
        below.translations.extend(below_[entry - own_].translations);
      } else if (!member.transform.identity) {  // neither baked nor placed nowhere
        add(scene_.instances[entry].world_from_model);
      }
    }
    const DMat3 inverse = glm::inverse(DMat3(own.linear));
    const double scale = 128 * kUnitRoundoff * below.largest_row;
    placement.from_origin = accel_.accuracy.transform == TransformLevel::kInverseMatrix;
    double beyond = 0;
    for (int axis = 0; axis < 3; ++axis) {
      double row = 0;
      for (int c = 0; c < 3; ++c) row += std::fabs(inverse[c][axis]);
      placement.slack[axis] = std::nextafter(static_cast<float>(scale * row), INFINITY);
      beyond = std::max({beyond, double(node.world.lo[axis]) - below.translations.lo[axis],
                         double(below.translations.hi[axis]) - node.world.hi[axis]});
    }
    if (placement.from_origin)
      for (int axis = 0; axis < 3; ++axis)
        beyond = std::max(
            {beyond, std::fabs(double(below.translations.lo[axis])), std::fabs(double(below.translations.hi[axis]))});
    placement.beyond = std::nextafter(static_cast<float>(2 * beyond), INFINITY);
  }

  const scene::Scene& scene_;
  const std::function<PlacedBox(std::uint32_t)>& box_of_;
  Executor& executor_;
  Accel& accel_;
  LevelPlan plan_;
  std::size_t own_;                       // instances of the scene
  std::vector<LevelPlan::Level> levels_;  // as Accel::groups
  std::vector<Below> below_;
  std::map<std::pair<int, std::uint32_t>, Structure> by_structure_;  // by room and group
};

}  // namespace

TopMembers build_group_levels(const scene::Scene& scene, const BvhConfig& config,
                              const std::function<PlacedBox(std::uint32_t)>& box_of, Executor& executor, Accel& accel) {
  return GroupLevels(scene, config, box_of, executor, accel).run();
}

}  // namespace carousel::accel
