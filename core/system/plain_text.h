#pragma once

#include <string>
#include <string_view>

namespace carousel {

/// Text of a file or of the command line without characters that a terminal would obey, or that hide or reorder what
/// stands beside them. A '?' replaces each control character (U+0000 to U+001F, U+007F to U+009F), each invisible
/// format character (such as U+202E, which turns the direction of reading; Unicode Technical Report 36, section 2.8),
/// and each byte that is not UTF-8. The ASCII characters in `keep` stay.
std::string plain_text(std::string_view text, std::string_view keep = "");

}  // namespace carousel
