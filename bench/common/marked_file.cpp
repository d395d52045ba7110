#include "bench/common/marked_file.h"

#include <stdexcept>

namespace carousel::bench {

std::string replace_marked(const std::string& text, const std::string& name, const std::string& body) {
  const std::string open = "<!-- bench:" + name + " -->", close = "<!-- /bench:" + name + " -->";
  const std::size_t begin = text.find(open);
  const std::size_t end = begin == std::string::npos ? begin : text.find(close, begin);
  if (end == std::string::npos) throw std::runtime_error("expected the markers " + open + " and " + close);
  return text.substr(0, begin + open.size()) + "\n\n" + body + "\n" + text.substr(end);
}

}  // namespace carousel::bench
