#pragma once

#include <string>
#include <string_view>

namespace carousel {

/// Text of a file or of the command line without control characters, which a terminal would obey: each byte below 32,
/// byte 127 and each character U+0080 to U+009F (in UTF-8) is replaced by '?'. The characters in `keep` stay.
std::string plain_text(std::string_view text, std::string_view keep = "");

}  // namespace carousel
