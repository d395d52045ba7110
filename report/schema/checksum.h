#pragma once

namespace carousel::report {

inline constexpr const char* kChecksumMeaning =
    "digest of all the other keys but `host`; a file that is read back and does not fit it is refused";

}  // namespace carousel::report
