#pragma once

#include <cstdint>
#include <filesystem>

namespace carousel::scene {

/// Refuses a PLY file whose header announces more elements than the file has bytes, as each takes one at least, or does
/// not end. Assimp believes the header, and reads zeros for minutes. A file that is no PLY passes, and so does one
/// without a header that can be understood, which Assimp refuses. `bytes` is the size of the file. Throws SceneError
/// with the line.
void check_ply(const std::filesystem::path& file, std::uint64_t bytes);

}  // namespace carousel::scene
