#pragma once

#include <filesystem>
#include <string>

namespace carousel::app {

/// True if a sweep has begun to write its points to the folder.
bool is_sweep(const std::filesystem::path& folder);

/// The page of a sweep whose results are not written yet: the points that are finished, the newest first. Browsers load
/// it again every few seconds.
std::string live_sweep_page(const std::filesystem::path& folder);

}  // namespace carousel::app
