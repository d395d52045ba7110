#include "core/system/plain_text.h"

namespace carousel {

std::string plain_text(std::string_view text, std::string_view keep) {
  std::string out;
  out.reserve(text.size());
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const auto next = static_cast<unsigned char>(i + 1 < text.size() ? text[i + 1] : '\0');
    const bool c1 = byte == 0xc2 && next >= 0x80 && next < 0xa0;
    const bool control = byte < 32 || byte == 127;
    if (c1) {
      out += '?';
      ++i;
    } else {
      out += control && keep.find(text[i]) == keep.npos ? '?' : text[i];
    }
  }
  return out;
}

}  // namespace carousel
