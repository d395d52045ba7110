#pragma once

#include <vector>

#include "accel/builders/binary/sah_build.h"
#include "core/system/executor.h"

namespace carousel::accel {

/// Moves subtrees of a binary tree to where the areas of its inner nodes add up to less: for each of the nodes, the
/// best other place is searched for, and the moves that gain most are made, in several rounds (Meister, Bittner 2018,
/// "Parallel reinsertion for bounding volume hierarchy optimization"). Leaves stay as they are; node 0 stays the root.
/// The tree is the same for any executor. It becomes no deeper than the
/// deepest that build_sah() makes, or than it was.
void reinsert(BinaryTree& nodes, Executor& executor);

}  // namespace carousel::accel
