#include "core/text/line_reader.h"

#include <ios>

namespace carousel {

bool LineReader::next() {
  if (too_long_ || !in_) return false;
  line_.clear();
  bool any = false;
  try {
    std::streambuf& bytes = *in_.rdbuf();
    for (int c = bytes.sbumpc(); c != std::streambuf::traits_type::eof(); c = bytes.sbumpc()) {
      any = true;
      if (c == '\n') break;
      too_long_ = line_.size() > longest_;  // by one, which may be \r
      if (too_long_) return true;
      line_ += static_cast<char>(c);
    }
  } catch (const std::ios_base::failure&) {
    in_.setstate(std::ios::badbit);
    return false;
  }
  if (!line_.empty() && line_.back() == '\r') line_.pop_back();
  too_long_ = line_.size() > longest_;
  return any;
}

}  // namespace carousel
