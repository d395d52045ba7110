#include "report/html/bundle.h"

#include <cstddef>

// The files are put into the program as they are. Built with g++ or Clang, so that .incbin is known.
#define CAROUSEL_EMBED(name, file)                                                                           \
  asm(".pushsection .rodata\n.global carousel_" name "_begin\n.global carousel_" name "_end\ncarousel_" name \
      "_begin:\n.incbin \"" file "\"\ncarousel_" name "_end:\n.byte 0\n.popsection\n")

CAROUSEL_EMBED("css", CAROUSEL_PAGE_CSS);
extern "C" const char carousel_css_begin[], carousel_css_end[];
#ifdef CAROUSEL_PAGE_JS
CAROUSEL_EMBED("js", CAROUSEL_PAGE_JS);
extern "C" const char carousel_js_begin[], carousel_js_end[];
#endif

namespace carousel::report::html {

std::string_view style_sheet() {
  return {carousel_css_begin, static_cast<std::size_t>(carousel_css_end - carousel_css_begin)};
}

std::string_view script_bundle() {
#ifdef CAROUSEL_PAGE_JS
  return {carousel_js_begin, static_cast<std::size_t>(carousel_js_end - carousel_js_begin)};
#else
  return {};
#endif
}

}  // namespace carousel::report::html
