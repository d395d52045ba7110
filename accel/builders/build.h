#pragma once

#include "accel/builders/file/tree_file.h"
#include "accel/structure/accel.h"
#include "core/config/fields/accuracy.h"
#include "core/config/fields/bvh.h"
#include "core/config/fields/cull_planes.h"
#include "core/system/executor.h"
#include "scene/model/scene.h"

namespace carousel::accel {

/// Deterministic for any executor. The transform level of `accuracy` decides the contents of instances and how far
/// their world boxes are padded. Throws SceneError when the scene has more nodes or blocks than a NodeRef can name.
/// With `trees` the structures over meshes are those of the file; a SceneError names the line that does not fit the
/// scene. With `ranks` each of them calls, builds the structures of its share of the meshes, and has these and the top
/// level (Partition); `planes`, groups, elements other than boxes, quantised boxes and `trees` are then not possible.
Accel build(const scene::Scene& scene, const BvhConfig& config, Executor& executor, const AccuracyConfig& accuracy = {},
            const CullPlanesConfig& planes = {}, const BuildRanks* ranks = nullptr, const TreeFile* trees = nullptr);

}  // namespace carousel::accel
