#pragma once

#include <chrono>
#include <cstdint>
#include <cstdio>
#include <string>
#include <string_view>

namespace carousel::report {

/// One line on a terminal that is written over as a run goes on, and wiped at its end. Does nothing when
/// `out` is not a terminal. One thread.
class ProgressLine {
 public:
  explicit ProgressLine(std::FILE* out);
  ~ProgressLine();
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  /// `fraction` of the work is done, in [0, 1]; so far it came to `count` of `unit` ("rays", "trials"), which may start
  /// again from 0. `stage`: of the work, if it is not the run itself. The line shows the rate over the whole time, and
  /// the time that remains as if the rest went as fast. It never is wider than the terminal.
  void update(double fraction, std::uint64_t count, std::string_view unit = "rays", std::string_view stage = "");
  bool shown() const { return out_ != nullptr; }

 private:
  std::FILE* out_;  ///< null: not a terminal
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  std::uint64_t last_ = 0, whole_ = 0;  ///< the last count, and all counts before it started again
};

/// The text of a line of progress, at most `width` columns wide: the parts that matter less are left out first.
std::string progress_text(double fraction, double seconds, std::uint64_t count, std::string_view unit,
                          std::string_view stage, std::size_t width);

}  // namespace carousel::report
