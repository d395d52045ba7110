#include "report/text/fit_lines.h"

#include <algorithm>
#include <vector>

namespace carousel::report {

namespace {

constexpr std::size_t kNarrowest = 20;

bool is_inside_character(char c) {
  return (static_cast<unsigned char>(c) & 0xc0) == 0x80;
}

/// A word with the spaces before it.
struct Word {
  std::size_t spaces;
  std::string_view text;
};

std::vector<Word> words_of(std::string_view line) {
  std::vector<Word> out;
  for (std::size_t at = 0; at < line.size();) {
    const std::size_t begin = std::min(line.find_first_not_of(' ', at), line.size());
    if (begin == line.size()) break;
    const std::size_t end = std::min(line.find(' ', begin), line.size());
    out.push_back({begin - at, line.substr(begin, end - begin)});
    at = end;
  }
  return out;
}

/// The column where a broken line goes on: below the second column of a table, if that leaves room.
std::size_t indent_of(std::string_view line, std::size_t width) {
  const std::size_t first = std::min(line.find_first_not_of(' '), line.size());
  if (first >= 2) return std::min(first, width / 2);
  const std::size_t gap = line.find("  ", first);
  if (gap == line.npos) return 2;
  const std::size_t second = columns_of(line.substr(0, std::min(line.find_first_not_of(' ', gap), line.size())));
  return second <= width / 3 ? second : 2;
}

void fit(std::string_view line, std::size_t width, std::string& out) {
  if (columns_of(line) <= width) {
    out += line;
    return;
  }
  const std::size_t indent = indent_of(line, width);
  std::size_t column = 0;
  for (const Word& word : words_of(line)) {
    std::string_view text = word.text;
    if (column + word.spaces + columns_of(text) <= width) {
      out.append(word.spaces, ' ');
      column += word.spaces;
    } else if (column > indent) {
      out += '\n';
      out.append(indent, ' ');
      column = indent;
    }
    while (column + columns_of(text) > width) {  // a word longer than a line
      const std::string piece = cut_to(text, width - column);
      out += piece + '\n';
      out.append(indent, ' ');
      column = indent;
      text.remove_prefix(piece.size());
    }
    out += text;
    column += columns_of(text);
  }
}

}  // namespace

std::size_t columns_of(std::string_view text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return !is_inside_character(c); }));
}

std::string cut_to(std::string_view text, std::size_t width) {
  std::size_t columns = 0, at = 0;
  for (; at < text.size(); ++at)
    if (!is_inside_character(text[at]) && ++columns > width) break;
  return std::string(text.substr(0, at));
}

std::string fit_lines(std::string_view text, std::size_t width) {
  width = std::max(width, kNarrowest);
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t end = text.find('\n', at);
    fit(text.substr(at, end == text.npos ? text.npos : end - at), width, out);
    if (end == text.npos) break;
    out += '\n';
    at = end + 1;
  }
  return out;
}

}  // namespace carousel::report
