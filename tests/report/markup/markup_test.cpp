#include "report/markup/markup.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "report/html/page.h"

namespace carousel::report::html {
namespace {

using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

TEST(Markup, EscapesAllTextButItsOwnLiterals) {
  EXPECT_EQ(markup("<p title=\"{}\">{}</p>", "a\"b'", "<b>&").str(), "<p title=\"a&quot;b&#39;\">&lt;b&gt;&amp;</p>");
  EXPECT_EQ(markup("<div>{}</div>", markup("<b>{:.1f}</b>", 1.25)).str(), "<div><b>1.2</b></div>");
  EXPECT_EQ(escaped("a\x01\nb"), "a\nb");
}

TEST(Markup, DataOfAScriptCannotEndIt) {
  const std::string html = json_script("facts", {{"a", "</script><!--\xe2\x80\xa8\xe2\x80\xa9&"}}).str();
  EXPECT_EQ(html,
            "<script type=\"application/json\" id=\"facts\">"
            "{\"a\":\"\\u003c/script\\u003e\\u003c!--\\u2028\\u2029\\u0026\"}</script>\n");
}

TEST(Markup, PagesRunNoScriptButTheirOwn) {
  const std::string page = page_of("<title>", "<b>", {{"\"><i>", "<u>", markup("<p>{}</p>", "text")}}, {}, {});
  EXPECT_THAT(page, ContainsRegex("<meta http-equiv=\"Content-Security-Policy\" content=\"default-src &#39;none&#39;; "
                                  "script-src &#39;(sha256-[A-Za-z0-9+/=]+|none)&#39;; style-src-elem "
                                  "&#39;sha256-[A-Za-z0-9+/=]+&#39;"));
  for (const char* raw : {"<b>", "<i>", "<u>"}) EXPECT_THAT(page, Not(HasSubstr(raw)));
}

}  // namespace
}  // namespace carousel::report::html
