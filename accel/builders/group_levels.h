#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "accel/structure/accel.h"
#include "core/config/fields/bvh.h"
#include "core/system/executor.h"
#include "scene/model/scene.h"

namespace carousel::accel {

/// A box around the contents of an instance, in the space from which it is placed: of a baked instance, its world box.
struct PlacedBox {
  Aabb box;
  scene::Affine world_from_box;
};

/// The members of the top level, when all levels below it are built.
struct TopMembers {
  std::vector<std::uint32_t> instances;
  int groups_depth = 0;  ///< strips of groups' nodes on the longest way down
};

/// Builds the structures over groups that `config.levels` leaves room for and appends them to the structure, whose
/// instances are there already, with their roots and world boxes: one structure for all placements of a group below
/// which there is as much room, an entry of Accel::instances for each placement. Instances that lie deeper join the
/// lowest group that is kept, as do the members of groups with less than two members, or with a placement that is
/// singular.
TopMembers build_group_levels(const scene::Scene& scene, const BvhConfig& config,
                              const std::function<PlacedBox(std::uint32_t)>& box_of, Executor& executor, Accel& accel);

}  // namespace carousel::accel
