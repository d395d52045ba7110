#include "core/system/plain_text.h"

#include <gtest/gtest.h>

namespace carousel {
namespace {

TEST(PlainText, LeavesNothingThatATerminalObeysOrThatTurnsTheDirectionOfReading) {
  EXPECT_EQ(plain_text("a\x1b[2Jb\x7f\r\n"), "a?[2Jb???");
  EXPECT_EQ(plain_text("a\nb\rc", "\n"), "a\nb?c");
  EXPECT_EQ(plain_text("csi \xc2\x9b 31m"), "csi ? 31m");
  EXPECT_EQ(plain_text("invoice\xe2\x80\xaegnp.exe"), "invoice?gnp.exe");  // U+202E
  EXPECT_EQ(plain_text("\xe2\x81\xa6x\xe2\x81\xa9\xef\xbb\xbf\xe2\x80\x8b"),
            "?x???");                                                           // U+2066, U+2069, U+FEFF, U+200B
  EXPECT_EQ(plain_text("line\xe2\x80\xa8line\xf3\xa0\x81\x81"), "line?line?");  // U+2028, U+E0041
}

TEST(PlainText, KeepsWhatIsWritten) {
  const std::string_view text =
      "Stra\xc3\x9f"
      "e \xe6\x97\xa5\xe6\x9c\xac \xf0\x9f\x8e\xa0 \xe2\x80\x93 \xc2\xa0";
  EXPECT_EQ(plain_text(text), text);
  EXPECT_EQ(plain_text(""), "");
}

TEST(PlainText, ReplacesBytesThatAreNoUtf8) {
  EXPECT_EQ(plain_text("\x9b"
                       "31m"),
            "?31m");                                  // a control of an 8-bit terminal
  EXPECT_EQ(plain_text("\xc0\x8a\xe2\x80"), "????");  // an overlong line feed; a character that is cut off
  EXPECT_EQ(plain_text("\xed\xa0\x80\xf4\x90\x80\x80"), "???????");  // a surrogate; beyond U+10FFFF
  EXPECT_EQ(plain_text("\xc3(x"), "?(x");
}

}  // namespace
}  // namespace carousel
