#include "core/system/plain_text.h"

#include <algorithm>
#include <array>
#include <cstdint>

namespace carousel {

namespace {

struct Range {
  char32_t first, last;
};

// Controls, and format characters (general category Cf, and the line separators) that no script needs to be read.
constexpr auto kRemoved = std::to_array<Range>({
    {0x0, 0x1f},
    {0x7f, 0x9f},
    {0x61c, 0x61c},
    {0x180e, 0x180e},
    {0x200b, 0x200b},
    {0x200e, 0x200f},
    {0x2028, 0x202e},
    {0x2060, 0x206f},
    {0xfeff, 0xfeff},
    {0xfff9, 0xfffb},
    {0xe0000, 0xe007f},
});

bool is_removed(char32_t code) {
  return std::any_of(kRemoved.begin(), kRemoved.end(),
                     [=](const Range& range) { return range.first <= code && code <= range.last; });
}

struct Character {
  char32_t code = 0;
  std::size_t bytes = 0;  // 0: the text does not begin with UTF-8
};

// The first character of a text that is not empty (RFC 3629: no overlong forms, no surrogates, up to U+10FFFF).
Character first_character(std::string_view text) {
  const auto lead = static_cast<unsigned char>(text[0]);
  if (lead < 0x80) return {lead, 1};
  const std::size_t bytes = lead >= 0xf0 ? 4 : lead >= 0xe0 ? 3 : 2;
  if (lead < 0xc2 || lead > 0xf4 || text.size() < bytes) return {};
  char32_t code = lead & (0x7fu >> bytes);
  for (std::size_t i = 1; i < bytes; ++i) {
    const auto next = static_cast<unsigned char>(text[i]);
    if ((next & 0xc0) != 0x80) return {};
    code = code << 6 | (next & 0x3f);
  }
  constexpr std::array<char32_t, 5> least = {0, 0, 0x80, 0x800, 0x10000};
  const bool surrogate = code >= 0xd800 && code <= 0xdfff;
  return code < least[bytes] || code > 0x10ffff || surrogate ? Character{} : Character{code, bytes};
}

}  // namespace

std::string plain_text(std::string_view text, std::string_view keep) {
  std::string out;
  out.reserve(text.size());
  while (!text.empty()) {
    const Character at = first_character(text);
    const std::size_t bytes = std::max<std::size_t>(at.bytes, 1);
    const bool kept = at.bytes == 1 && keep.find(text[0]) != keep.npos;
    if (at.bytes == 0 || (is_removed(at.code) && !kept))
      out += '?';
    else
      out += text.substr(0, bytes);
    text.remove_prefix(bytes);
  }
  return out;
}

}  // namespace carousel
