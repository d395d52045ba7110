#pragma once

#include <cstdint>

namespace carousel::report {

/// The version of the keys of all documents that the program writes and reads back (`schema_version`). It is raised
/// when a key is renamed or moved: 2 since `units.dispatch_busy`.
inline constexpr std::int64_t kDocumentVersion = 2;

}  // namespace carousel::report
