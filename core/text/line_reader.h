#pragma once

#include <cstddef>
#include <istream>
#include <string>

namespace carousel {

/// Reads a text line by line and never holds more than one line of bounded length, so that input without ends of lines
/// (a device, a binary file) takes no memory.
class LineReader {
 public:
  /// `in` must outlive the reader. A line may have `longest` bytes.
  LineReader(std::istream& in, std::size_t longest) : in_(in), longest_(longest) {}

  /// Reads the next line into line(), without its end (\n or \r\n). Returns false at the end of the text, and after a
  /// line that was too long. If reading fails, the stream is bad afterwards.
  bool next();
  const std::string& line() const { return line_; }
  /// True if the last line has more bytes than allowed; line() then holds its beginning.
  bool too_long() const { return too_long_; }

 private:
  std::istream& in_;
  std::size_t longest_;
  std::string line_;
  bool too_long_ = false;
};

}  // namespace carousel
