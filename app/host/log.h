#pragma once

#include <chrono>
#include <string>
#include <vector>

namespace carousel::app {

/// The options of logging, which all commands that work for long have.
struct LogArguments {
  std::string level;  ///< debug, info, warning or error; empty: info in a file, warning on the terminal
  std::string file;   ///< a file that gets the messages; the terminal then has warnings and errors only
};

/// The levels that a user may name.
const std::vector<std::string>& log_levels();

/// Sends messages to stderr, and to a file if one is named. Text of scenes and other files loses its control
/// characters. `quiet` leaves only errors on the terminal. Throws FileError if the file cannot be written.
void start_log(const LogArguments& arguments, bool quiet);

/// Ends the file of messages with the exit status, which a file of a killed program lacks. Returns the status: also
/// that of a file error if messages could not be written and the command found no worse.
int end_log(int status);

/// A phase of a command. Its beginning is a message of level debug, its end with the time one of level info.
class Phase {
 public:
  explicit Phase(std::string name);
  ~Phase();
  Phase(const Phase&) = delete;
  Phase& operator=(const Phase&) = delete;

  /// Sets the result of the phase, for the message of its end.
  void result(std::string text) { result_ = std::move(text); }
  double seconds() const;

 private:
  std::string name_, result_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
  int exceptions_;  ///< under way at the start: a phase that fails says so
};

}  // namespace carousel::app
