#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace carousel::report::html {

/// A picture to put into a page.
struct Picture {
  std::string mime_type;  ///< image/png or image/webp; empty: there is no picture
  std::string bytes;
};

/// A part of a page, with a heading of its own.
struct Section {
  std::string id, title, body;  ///< the body is HTML; a section with an empty body is left out
};

/// A whole page in one file: head, style, navigation, sections, data, scripts. `facts` is what the scripts need beside
/// the tables. `data` is HTML with the script elements of further data, or nothing.
std::string page_of(const std::string& title, const std::string& subtitle, const std::vector<Section>& sections,
                    const nlohmann::ordered_json& facts, const std::string& data);

}  // namespace carousel::report::html
