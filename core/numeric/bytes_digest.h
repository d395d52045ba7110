#pragma once

#include <string>
#include <string_view>

namespace carousel {

/// 128 bits as hex digits that name these bytes: equal bytes have equal digests, and others by chance alone. It does
/// not withstand somebody who looks for equal digests.
std::string bytes_digest(std::string_view bytes);

}  // namespace carousel
