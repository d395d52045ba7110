#pragma once

#include <filesystem>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <sys/types.h>

#include "core/module/http_server.h"

namespace carousel::app {

/// Simulates points between those of a sweep, as the page of the sweep asks for them: one at a time, each by a process
/// of this program, into `asked/NAME` of the sweep's folder, where NAME is made of the values. Nothing else is written.
/// Any thread.
class AskedPoints {
 public:
  AskedPoints() = default;
  /// Ends the run.
  ~AskedPoints();
  AskedPoints(const AskedPoints&) = delete;
  AskedPoints& operator=(const AskedPoints&) = delete;

  /// Begins a run of the sweep in `folder`, which is a path without links. `keys` has to have each key of the sweep
  /// once: a number within the sweep's values where all of these are numbers, else one of them. 202 with {"name"}, or
  /// 400 with what is wrong, or 409 while a run goes on.
  HttpAnswer start(const std::filesystem::path& folder, const std::vector<std::pair<std::string, std::string>>& keys);
  /// How the run of this name is: {"state": running, done or failed}, with the `results` of the sweep and the `page`,
  /// or an `error`; 404 if there is none.
  HttpAnswer state(const std::filesystem::path& folder, const std::string& name);

 private:
  void run(const std::filesystem::path& folder, const std::string& name, std::vector<std::string> words);

  std::mutex mutex_;
  std::filesystem::path running_;  // asked/NAME; empty: none
  pid_t process_ = 0;
  std::jthread waits_;
};

}  // namespace carousel::app
