#include "core/config/graph/node_names.h"

#include <algorithm>
#include <charconv>
#include <utility>

#include <fmt/format.h>

#include "core/text/edit_distance.h"

namespace carousel::config {

namespace {

bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

/// A number of a node in its group.
std::optional<std::int64_t> index_of(std::string_view text) {
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (text.empty() || text[0] == '-' || error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// First and last index in the brackets of a group of `size`.
std::optional<std::pair<std::int64_t, std::int64_t>> range_of(std::string_view text, std::int64_t size) {
  if (text == "*") return std::pair{std::int64_t{0}, size - 1};
  const std::size_t dots = text.find("..");
  const auto first = index_of(text.substr(0, dots)), last = dots == text.npos ? first : index_of(text.substr(dots + 2));
  if (!first || !last || std::max(*first, *last) >= size) return std::nullopt;
  return std::pair{*first, *last};
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && text.front() == ' ') text.remove_prefix(1);
  while (!text.empty() && text.back() == ' ') text.remove_suffix(1);
  return text;
}

}  // namespace

bool NodeNames::is_name(std::string_view text) {
  return !text.empty() && is_letter(text[0]) &&
         std::all_of(text.begin(), text.end(), [](char c) { return is_letter(c) || (c >= '0' && c <= '9'); });
}

bool NodeNames::add(const std::string& name, std::uint32_t first, std::optional<std::int64_t> size) {
  return groups_.emplace(name, Group{first, size}).second;
}

std::string NodeNames::unknown(std::string_view name) const {
  constexpr std::size_t kLongest = 64;
  std::vector<std::string> known;
  for (const auto& [one, group] : groups_) known.push_back(one);
  std::string text = fmt::format("expected a node, found '{}'", name);
  if (const auto near = nearest_name(name.substr(0, kLongest), known)) {
    const bool group = groups_.find(*near)->second.size.has_value();
    return text + fmt::format("; did you mean '{}{}'?", *near, group ? "[*]" : "");
  }
  if (known.empty()) return text + "; no node has a name that can be read";
  constexpr std::size_t kShown = 12;
  known.resize(std::min(known.size(), kShown));
  return text + fmt::format("; known are {}", fmt::join(known, ", "));
}

std::vector<std::uint32_t> NodeNames::find(std::string_view pattern, std::string& error) const {
  std::vector<std::uint32_t> out;
  for (bool more = true; more;) {
    const std::size_t comma = std::min(pattern.find(','), pattern.size());
    const std::vector<std::uint32_t> nodes = find_one(trimmed(pattern.substr(0, comma)), error);
    if (nodes.empty()) return {};
    out.insert(out.end(), nodes.begin(), nodes.end());
    more = comma < pattern.size();
    pattern.remove_prefix(std::min(comma + 1, pattern.size()));
  }
  return out;
}

std::vector<std::uint32_t> NodeNames::find_one(std::string_view pattern, std::string& error) const {
  const std::size_t bracket = std::min(pattern.find('['), pattern.size());
  const auto found = groups_.find(pattern.substr(0, bracket));
  if (found == groups_.end()) {
    error = unknown(pattern.substr(0, bracket));
    return {};
  }
  const auto& [name, group] = *found;
  if (bracket == pattern.size()) {
    if (!group.size) return {group.first};
    error = fmt::format("{0} is a group of {1}; expected {0}[*], {0}[0] or {0}[0..{2}], found '{0}'", name, *group.size,
                        *group.size - 1);
    return {};
  }
  if (!group.size) {
    error = fmt::format("{0} is one node; expected {0}, found '{1}'", name, pattern);
    return {};
  }
  const auto range = pattern.back() == ']'
                         ? range_of(pattern.substr(bracket + 1, pattern.size() - bracket - 2), *group.size)
                         : std::nullopt;
  if (!range) {
    error = fmt::format("expected {0}[*], or {0}[i] or {0}[i..j] with numbers from 0 to {1}, found '{2}'", name,
                        *group.size - 1, pattern);
    return {};
  }
  std::vector<std::uint32_t> out;
  const std::int64_t step = range->first <= range->second ? 1 : -1;
  for (std::int64_t i = range->first; i != range->second + step; i += step)
    out.push_back(group.first + static_cast<std::uint32_t>(i));
  return out;
}

}  // namespace carousel::config
