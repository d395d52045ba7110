#include "report/text/progress_line.h"

#include <algorithm>
#include <string>

#include <fmt/format.h>
#include <unistd.h>

#include "report/text/number_text.h"
#include "report/text/ratio.h"

namespace carousel::report {

ProgressLine::ProgressLine(std::FILE* out) : out_(isatty(fileno(out)) ? out : nullptr) {}

ProgressLine::~ProgressLine() {
  if (!out_) return;
  fmt::print(out_, "\r\033[K");  // erase to the end of the line
  std::fflush(out_);
}

void ProgressLine::update(double fraction, std::uint64_t rays, std::string_view name) {
  if (!out_) return;
  constexpr std::size_t kWidth = 30;
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start_;
  const double part = std::clamp(fraction, 0.0, 1.0);
  const auto filled = static_cast<std::size_t>(part * kWidth);
  const std::string left =
      part > 0 ? fmt::format("  {} left", seconds_text(seconds.count() * (1 - part) / part)) : std::string();
  const std::string work =
      name.empty() ? fmt::format("{}rays  {}rays/s", scaled(double(rays)), scaled(ratio(double(rays), seconds.count())))
                   : std::string(name);
  fmt::print(out_, "\r[{}{}] {:3.0f} %  {}  {}{}\033[K", std::string(filled, '#'), std::string(kWidth - filled, '.'),
             100 * part, work, seconds_text(seconds.count()), left);
  std::fflush(out_);
}

}  // namespace carousel::report
