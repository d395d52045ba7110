#include "app/accuracy/case_text.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/text/edit_distance.h"

namespace carousel::app {

namespace {

/// Reads words from one line; its errors name the column.
class CaseLine {
 public:
  CaseLine(std::string_view text, const SourcePosition& place) : text_(text), place_(place) {}

  struct Word {
    std::string text;
    std::size_t at;
  };
  /// The text up to the next blank; empty at the end.
  Word word() {
    while (at_ < text_.size() && text_[at_] == ' ') ++at_;
    const std::size_t begin = at_;
    while (at_ < text_.size() && text_[at_] != ' ') ++at_;
    return {std::string(text_.substr(begin, at_ - begin)), begin};
  }
  [[noreturn]] void refuse(std::size_t at, const std::string& key, const std::string& message) const {
    SourcePosition position = place_;
    position.column += static_cast<int>(at);
    throw ConfigError({{position, key, message}});
  }

 private:
  std::string_view text_;
  SourcePosition place_;
  std::size_t at_ = 0;
};

std::string found(const std::string& word) {
  return word.empty() ? "the end" : "\"" + word + "\"";
}

/// One of `known`, by its index.
std::size_t choose(const CaseLine& line, const CaseLine::Word& word, const std::string& what,
                   const std::vector<std::string>& known) {
  for (std::size_t i = 0; i < known.size(); ++i)
    if (known[i] == word.text) return i;
  const auto near = nearest_name(word.text, known);
  line.refuse(word.at, "",
              fmt::format("expected {} ({}), found {}{}", what, fmt::join(known, ", "), found(word.text),
                          near ? "; did you mean " + *near + "?" : ""));
}

std::optional<float> number(const std::string& text) {
  if (text.empty() || std::isspace(static_cast<unsigned char>(text[0]))) return std::nullopt;
  char* end = nullptr;
  const float x = std::strtof(text.c_str(), &end);
  const bool named = text.find_first_of("iI") != std::string::npos;  // a written infinity, which is no overflow
  if (*end != '\0' || (std::isinf(x) && !named)) return std::nullopt;
  return x;
}

void read_field(const CaseLine& line, const CaseLine::Word& word, const accel::CaseField& field,
                accel::CaseValues& out) {
  const std::string name(field.name), start = name + "=";
  if (!word.text.starts_with(start))
    line.refuse(word.at, "", fmt::format("expected {}NUMBER,..., found {}", start, found(word.text)));
  std::size_t count = 0, begin = start.size();
  for (;; ++count) {
    const std::size_t comma = word.text.find(',', begin), end = std::min(comma, word.text.size());
    const std::string digits = word.text.substr(begin, end - begin);
    const std::optional<float> x = number(digits);
    if (!x)
      line.refuse(word.at + begin, name, fmt::format("expected a float such as 0x1.8p+1, found {}", found(digits)));
    out.push_back(*x);
    if (comma == std::string::npos) break;
    begin = comma + 1;
  }
  ++count;
  if (count >= field.count && count <= field.most && (count - field.count) % 3 == 0) return;
  const std::string wanted = field.count == field.most
                                 ? fmt::format("{} number{}", field.count, field.count == 1 ? "" : "s")
                                 : fmt::format("{} to {} numbers, three a point", field.count, field.most);
  line.refuse(word.at, name, fmt::format("expected {}, found {}", wanted, count));
}

}  // namespace

std::string case_text(const accel::Property& property, const AccuracyConfig& level, const accel::CaseValues& values) {
  std::string text = std::string(property.name) + " " + level_name(property, level);
  std::size_t at = 0;
  for (const accel::CaseField& field : property.fields) {
    const std::size_t count = &field == &property.fields.back() ? values.size() - at : field.count;
    for (std::size_t i = 0; i < count; ++i)
      text += (i == 0 ? fmt::format(" {}=", field.name) : ",") + fmt::format("{:a}", values[at + i]);
    at += count;
  }
  return text;
}

CertificateCase parse_case(std::string_view text, std::span<const accel::Property> properties,
                           const SourcePosition& place) {
  CaseLine line(text, place);
  std::vector<std::string> names;
  for (const accel::Property& property : properties) names.emplace_back(property.name);
  CertificateCase out;
  out.property = &properties[choose(line, line.word(), "a property or a file that holds cases", names)];
  const std::vector<AccuracyConfig> levels = levels_of(*out.property);
  names.clear();
  for (const AccuracyConfig& level : levels) names.push_back(level_name(*out.property, level));
  out.level = levels[choose(line, line.word(), "a level", names)];
  for (const accel::CaseField& field : out.property->fields) read_field(line, line.word(), field, out.values);
  if (const CaseLine::Word rest = line.word(); !rest.text.empty())
    line.refuse(rest.at, "", "expected the end, found " + found(rest.text));
  return out;
}

}  // namespace carousel::app
