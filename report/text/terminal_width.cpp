#include "report/text/terminal_width.h"

#include <charconv>
#include <cstdlib>
#include <string_view>

#include <sys/ioctl.h>
#include <unistd.h>

namespace carousel::report {

std::optional<std::size_t> terminal_width(std::FILE* out) {
  if (const char* text = std::getenv("COLUMNS")) {
    const std::string_view columns = text;
    std::size_t width = 0;
    const auto [end, error] = std::from_chars(columns.data(), columns.data() + columns.size(), width);
    if (error == std::errc{} && end == columns.data() + columns.size() && width > 0) return width;
  }
  winsize size{};
  const int descriptor = fileno(out);
  if (!isatty(descriptor) || ioctl(descriptor, TIOCGWINSZ, &size) != 0 || size.ws_col == 0) return std::nullopt;
  return size.ws_col;
}

}  // namespace carousel::report
