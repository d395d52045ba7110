#include "report/text/singular.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

namespace carousel::report {

namespace {

bool letter(char c) {
  return std::isalpha(static_cast<unsigned char>(c)) != 0;
}

std::string singular_noun(std::string_view plural) {
  const auto stem = [&](std::size_t less) { return std::string(plural.substr(0, plural.size() - less)); };
  if (plural == "leaves") return "leaf";
  if (plural == "caches") return "cache";
  if (plural.ends_with("ies")) return stem(3) + "y";
  for (const std::string_view ending : {"sses", "shes", "ches", "xes"})
    if (plural.ends_with(ending)) return stem(2);
  return stem(1);
}

/// The word that begins at `at`; empty if none does, if it is part of a unit, as in rays/s, or the end of a name before
/// a colon, which is the user's.
std::string_view word_at(std::string_view text, std::size_t at) {
  const auto* const end = std::find_if_not(text.begin() + static_cast<std::ptrdiff_t>(at), text.end(), letter);
  const std::string_view word = text.substr(at, static_cast<std::size_t>(end - text.begin()) - at);
  return end != text.end() && (*end == '/' || *end == '_' || *end == ':') ? std::string_view{} : word;
}

}  // namespace

std::string singular(const std::string& text) {
  constexpr std::array<std::string_view, 3> kAdjectives{"inner", "more", "shader"};
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    out += text[i];
    const bool alone = i == 0 || text[i - 1] == ' ' || text[i - 1] == '\n' || text[i - 1] == '(';
    if (text[i] != '1' || !alone || i + 1 >= text.size() || text[i + 1] != ' ') continue;
    std::size_t at = i + 2;
    std::string_view word = word_at(text, at);
    if (std::find(kAdjectives.begin(), kAdjectives.end(), word) != kAdjectives.end()) {
      at += word.size() + 1;
      word = at < text.size() ? word_at(text, at) : std::string_view{};
    }
    if (word.size() < 3 || !word.ends_with('s') || word.ends_with("ss")) continue;
    out += text.substr(i + 1, at - i - 1) + singular_noun(word);
    i = at + word.size() - 1;
  }
  return out;
}

}  // namespace carousel::report
