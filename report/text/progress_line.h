#pragma once

#include <chrono>
#include <cstdint>
#include <cstdio>
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

  /// `fraction` of the work is done, in [0, 1], and `rays` have been completed. `name`: of the work, if it is not the
  /// run itself. The time that remains is shown as if the rest went as fast.
  void update(double fraction, std::uint64_t rays, std::string_view name = "");
  bool shown() const { return out_ != nullptr; }

 private:
  std::FILE* out_;  ///< null: not a terminal
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

}  // namespace carousel::report
