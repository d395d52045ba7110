#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "report/markup/markup.h"

namespace carousel::report::html {

/// A picture to put into a page.
struct Picture {
  std::string mime_type;  ///< image/png or image/webp; empty: there is no picture
  std::string bytes;
};

/// A part of a page, with a heading of its own.
struct Section {
  std::string id, title;
  Html body;          ///< a section with an empty one is left out
  std::string tab{};  ///< the tab that shows it; empty: it always stands there
};

/// A whole page in one file: head, style, navigation, sections, data, scripts. `facts` is what the scripts need beside
/// the tables. `data` holds the script elements of further data, or nothing. The page carries a policy (Content
/// Security Policy Level 3, W3C) by which a browser runs no script but the program's own, known by its hash, and loads
/// nothing, or where it `asks` only from the server that it came from.
std::string page_of(const std::string& title, const std::string& subtitle, const std::vector<Section>& sections,
                    const nlohmann::ordered_json& facts, const Html& data, bool asks = false);

}  // namespace carousel::report::html
