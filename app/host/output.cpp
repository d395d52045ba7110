#include "app/host/output.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <string>

#include "core/system/error.h"

namespace carousel::app {

void print_result(std::string_view text) {
  const bool written = std::fwrite(text.data(), 1, text.size(), stdout) == text.size() && std::fflush(stdout) == 0;
  if (!written) throw FileError("cannot write to the standard output: " + std::string(std::strerror(errno)));
}

}  // namespace carousel::app
