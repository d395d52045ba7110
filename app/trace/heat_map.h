#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <vector>

#include "report/sections/rays/heat.h"
#include "ringbus/results/ray_times.h"

namespace carousel::app {

/// The part of the report. `pixels` row by row. Absent if no ray of any pixel was traced.
std::optional<report::Heat> heat_section(std::span<const ringbus::PixelCost> pixels, std::uint32_t width);

/// Writes heat_cycles.png, heat_tests.png, heat_hops.png and heat_waiting.png, from dark (nothing) to bright (the most
/// of any pixel), in equal steps or, with `log`, in equal ratios; and heat.csv with the numbers. Throws FileError.
void write_heat(const std::filesystem::path& folder, std::span<const ringbus::PixelCost> pixels, std::uint32_t width,
                bool log);

}  // namespace carousel::app
