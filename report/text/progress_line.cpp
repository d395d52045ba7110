#include "report/text/progress_line.h"

#include <algorithm>
#include <string>

#include <fmt/format.h>
#include <unistd.h>

#include "report/text/fit_lines.h"
#include "report/text/number_text.h"
#include "report/text/ratio.h"
#include "report/text/terminal_width.h"

namespace carousel::report {

ProgressLine::ProgressLine(std::FILE* out) : out_(isatty(fileno(out)) ? out : nullptr) {}

ProgressLine::~ProgressLine() {
  if (!out_) return;
  fmt::print(out_, "\r\033[K");  // erase to the end of the line
  std::fflush(out_);
}

void ProgressLine::update(double fraction, std::uint64_t count, std::string_view unit, std::string_view stage) {
  if (!out_) return;
  constexpr std::size_t kUnknownWidth = 100;
  if (count < last_) whole_ += last_;
  last_ = count;
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start_;
  const std::size_t width = terminal_width(out_).value_or(kUnknownWidth);
  fmt::print(out_, "\r{}\033[K", progress_text(fraction, seconds.count(), whole_ + count, unit, stage, width));
  std::fflush(out_);
}

std::string progress_text(double fraction, double seconds, std::uint64_t count, std::string_view unit,
                          std::string_view stage, std::size_t width) {
  constexpr std::size_t kBar = 30, kShortBar = 10;
  const double part = std::clamp(fraction, 0.0, 1.0);
  const std::string left = part > 0 ? seconds_text(seconds * (1 - part) / part) + " left" : "time left unknown";
  const auto amount = [&](double value) {  // "950 rays", "1.23 Mrays"
    const std::string number = scaled(value);
    const bool named = !number.empty() && (number.back() < '0' || number.back() > '9');
    return fmt::format("{}{}{}", number, named ? "" : " ", unit);
  };
  const std::string rate = amount(ratio(double(count), seconds)) + "/s";
  const auto line = [&](std::size_t bar, bool total, bool with_stage) {
    std::string out;
    if (bar > 0) {
      const auto filled = static_cast<std::size_t>(part * static_cast<double>(bar));
      out = fmt::format("[{}{}] ", std::string(filled, '#'), std::string(bar - filled, '.'));
    }
    out += fmt::format("{:3.0f} %  ", 100 * part);
    if (with_stage && !stage.empty()) out += fmt::format("{}  ", stage);
    if (total) out += amount(double(count)) + "  ";
    return out + fmt::format("{}  {}", rate, total ? seconds_text(seconds) + "  " + left : left);
  };
  struct Form {
    std::size_t bar;
    bool total, stage;
  };
  for (const Form& form : {Form{kBar, true, true}, Form{kShortBar, true, true}, Form{kShortBar, false, true},
                           Form{0, false, true}, Form{0, false, false}}) {
    std::string out = line(form.bar, form.total, form.stage);
    if (columns_of(out) < width) return out;  // the cursor needs the last column
  }
  return cut_to(line(0, false, false), width > 0 ? width - 1 : 0);
}

}  // namespace carousel::report
