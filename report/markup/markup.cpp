#include "report/markup/markup.h"

#include <utility>

namespace carousel::report::html {

std::string escaped(std::string_view text) {
  std::string out;
  out.reserve(text.size());
  for (const char c : text) {
    if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '&')
      out += "&amp;";
    else if (c == '"')
      out += "&quot;";
    else if (c == '\'')
      out += "&#39;";
    else if (static_cast<unsigned char>(c) >= 0x20 || c == '\n')
      out += c;
  }
  return out;
}

Html json_script(std::string_view id, const nlohmann::ordered_json& data) {
  const std::string json = data.dump(-1, ' ', false, nlohmann::ordered_json::error_handler_t::replace);
  // U+2028 and U+2029 end a line in a script of before ECMAScript 2019.
  constexpr std::pair<std::string_view, std::string_view> kReplaced[] = {
      {"<", "\\u003c"}, {">", "\\u003e"}, {"&", "\\u0026"}, {"\xe2\x80\xa8", "\\u2028"}, {"\xe2\x80\xa9", "\\u2029"}};
  std::string out = "<script type=\"application/json\" id=\"" + escaped(id) + "\">";
  for (std::size_t i = 0; i < json.size();) {
    std::size_t step = 1;
    std::string_view put(json.data() + i, 1);
    for (const auto& [found, with] : kReplaced)
      if (json.compare(i, found.size(), found) == 0) {
        put = with;
        step = found.size();
      }
    out += put;
    i += step;
  }
  return Html(out + "</script>\n");
}

}  // namespace carousel::report::html
