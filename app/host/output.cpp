#include "app/host/output.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>

#include "core/system/error.h"
#include "core/system/plain_text.h"
#include "report/text/fit_lines.h"
#include "report/text/terminal_width.h"

namespace carousel::app {

void print_result(std::string_view text) {
  const bool written = std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0;
  if (!written) throw FileError("cannot write to the standard output: " + std::string(std::strerror(errno)));
}

void print_text(std::string_view text) {
  const std::string plain = plain_text(text, "\n");
  const std::optional<std::size_t> width = report::terminal_width(stdout);
  print_result(width ? report::fit_lines(plain, *width) : plain);
}

}  // namespace carousel::app
