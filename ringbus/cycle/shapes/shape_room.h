#pragma once

#include <cstdint>
#include <vector>

#include "accel/structure/accel.h"
#include "core/config/config.h"
#include "core/system/error.h"

namespace carousel::ringbus::cycle {

/// The least `memory.shape_buffer_kib` with which any test finds room: for the largest strip of the structure, or the
/// largest block that collections are keyed by, together with what is stored of a transform.
std::int64_t least_shape_buffer_kib(const accel::Accel& accel, const AccuracyConfig& accuracy,
                                    const BvhConfig& bvh = {}, const MemoryConfig& memory = {},
                                    const CollectionsConfig& collections = {});

/// Issues of a machine whose shape buffers are too small for the structure; empty if there are none.
std::vector<ConfigIssue> check_shape_buffer(const Config& config, const accel::Accel& accel);

}  // namespace carousel::ringbus::cycle
