#pragma once

#include <string_view>

namespace carousel::report::html {

/// The style sheet of all pages, web/src/page.css.
std::string_view style_sheet();

/// The scripts of all pages with the charts of Apache ECharts, bundled from web/ when the program is built; empty if
/// npm's packages were not there.
std::string_view script_bundle();

}  // namespace carousel::report::html
