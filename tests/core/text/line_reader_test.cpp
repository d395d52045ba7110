#include "core/text/line_reader.h"

#include <sstream>
#include <streambuf>

#include <gtest/gtest.h>

namespace carousel {
namespace {

std::vector<std::string> lines_of(const std::string& text, std::size_t longest) {
  std::istringstream in(text);
  LineReader reader(in, longest);
  std::vector<std::string> out;
  while (reader.next()) out.push_back(reader.line() + (reader.too_long() ? "..." : ""));
  return out;
}

TEST(LineReader, SplitsAsGetlineDoesAndTakesTheEndsOfBothSystems) {
  using Lines = std::vector<std::string>;
  EXPECT_EQ(lines_of("", 4), Lines{});
  EXPECT_EQ(lines_of("\n", 4), Lines{""});
  EXPECT_EQ(lines_of("a\n\nbc\r\nd", 4), (Lines{"a", "", "bc", "d"}));
  EXPECT_EQ(lines_of("a\r", 4), Lines{"a"});
}

TEST(LineReader, EndsAtALineThatIsTooLong) {
  using Lines = std::vector<std::string>;
  EXPECT_EQ(lines_of("1234\n1234\r\n", 4), (Lines{"1234", "1234"}));
  EXPECT_EQ(lines_of("12345\n1\n", 4), Lines{"12345..."});
  EXPECT_EQ(lines_of("1\n123456", 4), (Lines{"1", "12345..."}));
  EXPECT_EQ(lines_of("12345", 4), Lines{"12345..."});
}

/// As many zeros as anybody reads.
class Zeros : public std::streambuf {
 public:
  std::size_t read = 0;

 private:
  int_type underflow() override {
    read += sizeof zeros_;
    setg(zeros_, zeros_, zeros_ + sizeof zeros_);
    return 0;
  }
  char zeros_[64] = {};
};

TEST(LineReader, TakesNoMoreOfAnEndlessLineThanAllowed) {
  Zeros zeros;
  std::istream in(&zeros);
  LineReader reader(in, 1000);
  EXPECT_TRUE(reader.next());
  EXPECT_TRUE(reader.too_long());
  EXPECT_FALSE(reader.next());
  EXPECT_LE(zeros.read, 1100u);
}

}  // namespace
}  // namespace carousel
