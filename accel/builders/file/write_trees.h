#pragma once

#include "accel/structure/accel.h"
#include "core/system/atomic_file.h"
#include "scene/model/scene.h"

namespace carousel::accel {

/// Writes the trees over the meshes of `scene`, whose structure is `accel`, as read_trees() reads them: a structure
/// that is built of the file has the same nodes and blocks in the same places. With bvh.storage: quantised the boxes
/// are those before. The top level is not in the file. Throws a ConfigError where a primitive is in several leaves, as
/// planes in space may have cut it, and FileError. Preconditions: all of the structure is here (no Partition).
void write_trees(AtomicFile& file, const Accel& accel, const scene::Scene& scene);

}  // namespace carousel::accel
