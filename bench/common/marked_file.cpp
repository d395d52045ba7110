#include "bench/common/marked_file.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <stdexcept>

#include "core/system/atomic_file.h"
#include "core/system/error.h"

namespace carousel::bench {

namespace {

bool replace_in(std::string& text, const std::string& name, const std::string& body) {
  const std::string open = "<!-- bench:" + name + " -->", close = "<!-- /bench:" + name + " -->";
  const std::size_t begin = text.find(open);
  const std::size_t end = begin == std::string::npos ? begin : text.find(close, begin);
  if (end == std::string::npos) return false;
  text = text.substr(0, begin + open.size()) + "\n\n" + body + "\n" + text.substr(end);
  return true;
}

}  // namespace

std::string read_text(const std::string& file) {
  std::ifstream in(file, std::ios::binary);
  if (!in) throw FileError("cannot read " + file);
  return {std::istreambuf_iterator<char>(in), {}};
}

void replace_marked(const std::vector<std::string>& files, const std::map<std::string, std::string>& bodies) {
  std::map<std::string, std::string> texts;
  for (const std::string& file : files) texts[file] = read_text(file);
  for (const auto& [name, body] : bodies)
    if (std::none_of(files.begin(), files.end(),
                     [&](const std::string& file) { return replace_in(texts[file], name, body); }))
      throw std::runtime_error("expected the markers <!-- bench:" + name + " --> and <!-- /bench:" + name + " -->");
  for (const auto& [file, text] : texts) write_file(file, text);
}

}  // namespace carousel::bench
