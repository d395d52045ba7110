#include "accel/builders/level_plan.h"

#include <algorithm>
#include <cmath>

#include <glm/matrix.hpp>

#include "accel/transform/transform.h"

namespace carousel::accel {

namespace {

/// True if rays can be brought to a group that stands so, and boxes from there.
bool has_inverse(const scene::Affine& m, TransformLevel level) {
  constexpr double kLargest = 0x1p60;  // boxes stay in the range of floats
  InstanceTransform ignored;
  if (!make_transform(m, ignored, level)) return false;
  const DMat3 inverse = glm::inverse(DMat3(m.linear));
  for (int c = 0; c < 3; ++c)
    for (int row = 0; row < 3; ++row)
      if (!(std::fabs(inverse[c][row]) <= kLargest)) return false;
  return true;
}

}  // namespace

LevelPlan::LevelPlan(const scene::Scene& scene, int room, TransformLevel transform)
    : scene_(scene), room_(room), usable_(scene.groups.size(), true) {
  first_child_.reserve(scene.placements.size());
  std::size_t children = 0;
  for (const scene::GroupPlacement& placement : scene.placements) {
    first_child_.push_back(static_cast<std::uint32_t>(children));
    children += scene.groups[placement.group].members.size();
    if (!has_inverse(placement.world_from_group, transform)) usable_[placement.group] = false;
  }
  children_.resize(children);
  for (std::uint32_t p = 0; p < scene.placements.size(); ++p)
    if (const scene::GroupPlacement& placement = scene.placements[p]; placement.parent != scene::kNoPlacement)
      children_[first_child_[placement.parent] + placement.member] = p;
  for (std::uint32_t i = 0; i < scene.instances.size(); ++i)
    if (const scene::Instance& instance = scene.instances[i]; instance.placement != scene::kNoPlacement)
      children_[first_child_[instance.placement] + instance.member] = i;
  // A group stands before those that it is a member of.
  for (const scene::Group& group : scene.groups) {
    int height = 1;
    for (int r = 1; r <= room_; ++r) {
      std::uint64_t members = 0;
      for (const scene::Group::Member& member : group.members) {
        if (!member.is_group)
          members += !is_empty(member.index);
        else
          members += is_level(member.index, r - 1) ? 1 : count(member.index, r);
      }
      counts_.push_back(members);
    }
    for (const scene::Group::Member& member : group.members)
      if (member.is_group) height = std::max(height, 1 + height_[member.index]);
    height_.push_back(height);
  }
}

bool LevelPlan::is_empty(std::uint32_t mesh) const {
  return scene_.meshes[mesh].indices.empty() && scene_.meshes[mesh].spheres.empty();
}

std::uint64_t LevelPlan::count(std::uint32_t group, int room) const {
  return counts_[std::size_t{group} * static_cast<std::size_t>(room_) + static_cast<std::size_t>(room - 1)];
}

bool LevelPlan::is_level(std::uint32_t group, int room) const {
  return room >= 1 && usable_[group] && count(group, room) >= 2;
}

LevelPlan::Level LevelPlan::level_of(std::uint32_t placement, int room) const {
  const std::uint32_t group = scene_.placements[placement].group;
  return {placement, group, std::min(room, height_[group])};
}

void LevelPlan::expand(std::uint32_t placement, int room_of_members, std::vector<Member>& out) const {
  // An explicit stack instead of recursion: groups may be in one another as deep as a file is long.
  struct Open {
    std::uint32_t placement;
    std::size_t next;
  };
  std::vector<Open> stack{{placement, 0}};
  while (!stack.empty()) {
    Open& at = stack.back();
    const std::vector<scene::Group::Member>& members = scene_.groups[scene_.placements[at.placement].group].members;
    if (at.next == members.size()) {
      stack.pop_back();
      continue;
    }
    const scene::Group::Member& member = members[at.next];
    const std::uint32_t child = children_[first_child_[at.placement] + at.next];
    ++at.next;
    if (!member.is_group) {
      if (!is_empty(member.index)) out.push_back({child, std::nullopt});
    } else if (is_level(member.index, room_of_members)) {
      out.push_back({0, level_of(child, room_of_members)});
    } else {
      stack.push_back({child, 0});
    }
  }
}

std::vector<LevelPlan::Member> LevelPlan::members(const Level& level) const {
  std::vector<Member> out;
  expand(level.placement, level.room - 1, out);
  return out;
}

std::vector<LevelPlan::Member> LevelPlan::top() const {
  std::vector<Member> out;
  for (std::uint32_t i = 0; i < scene_.instances.size(); ++i)
    if (const scene::Instance& instance = scene_.instances[i];
        instance.placement == scene::kNoPlacement && !is_empty(instance.mesh.value))
      out.push_back({i, std::nullopt});
  for (std::uint32_t p = 0; p < scene_.placements.size(); ++p) {
    if (scene_.placements[p].parent != scene::kNoPlacement) continue;
    if (is_level(scene_.placements[p].group, room_))
      out.push_back({0, level_of(p, room_)});
    else
      expand(p, room_, out);
  }
  return out;
}

}  // namespace carousel::accel
