#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "core/config/fields/accuracy.h"
#include "scene/model/scene.h"

namespace carousel::accel {

/// Decides which of the scene's groups become levels of the structure, and which are left to the group around them.
class LevelPlan {
 public:
  /// A placed group that becomes a level, `room` levels of groups at most in it, itself among them. Groups with equal
  /// `group` and `room` have the same members.
  struct Level {
    std::uint32_t placement, group;
    int room;
  };
  /// A member of a level, or of the top level: either an instance or a group that is a level itself.
  struct Member {
    std::uint32_t instance = 0;
    std::optional<Level> level;
  };

  /// Keeps a reference. `room`: levels of groups below the top level.
  LevelPlan(const scene::Scene& scene, int room, TransformLevel transform);

  /// Instances without a group first, then groups.
  std::vector<Member> top() const;
  std::vector<Member> members(const Level& level) const;

 private:
  bool is_empty(std::uint32_t mesh) const;
  bool is_level(std::uint32_t group, int room) const;
  std::uint64_t count(std::uint32_t group, int room) const;
  Level level_of(std::uint32_t placement, int room) const;
  void expand(std::uint32_t placement, int room_of_members, std::vector<Member>& out) const;

  const scene::Scene& scene_;
  int room_;
  std::vector<std::uint32_t> first_child_;  // in children_, by placement
  std::vector<std::uint32_t> children_;     // instances or placements, as the group's members are
  std::vector<bool> usable_;                // by group: rays can be brought to all placements
  std::vector<int> height_;                 // by group: levels of groups in it, itself among them
  std::vector<std::uint64_t> counts_;       // by group and room: members that are instances or levels
};

}  // namespace carousel::accel
