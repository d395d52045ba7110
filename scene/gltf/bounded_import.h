#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "scene/gltf/import.h"

namespace carousel::scene {

/// load_gltf_from_memory() of import.h, whose allocations for what the file announces come to at most `budget_bytes`;
/// the functions there take MemoryBudget::of_process().
Scene load_gltf_within(std::uint64_t budget_bytes, std::span<const std::byte> bytes, const std::string& name,
                       const WarningSink& warn = {}, const ImageChoice& images = {},
                       const std::optional<PoseChoice>& pose = {});

}  // namespace carousel::scene
