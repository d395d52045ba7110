#pragma once

#include <stop_token>
#include <thread>

namespace carousel::app {

/// During its lifetime the first SIGINT requests a stop instead of ending the program; a second one ends it at once.
/// At most one object may exist at a time.
class InterruptScope {
 public:
  InterruptScope();
  ~InterruptScope();
  InterruptScope(const InterruptScope&) = delete;
  InterruptScope& operator=(const InterruptScope&) = delete;

  std::stop_token token() const { return source_.get_token(); }
  bool interrupted() const;

 private:
  std::stop_source source_;
  std::jthread watcher_;  // request_stop() must not be called from a signal handler
};

}  // namespace carousel::app
