#pragma once

#include <stop_token>
#include <thread>

#include "app/host/exit_status.h"
#include "core/system/stop_request.h"

namespace carousel::app {

/// The exit status of work that was interrupted: 128 plus the number of the signal that came first, kInterrupted if
/// none has come.
ExitStatus interrupted_status();

/// The signal that came first, 0 if none has come; and one of another rank, which counts as if it had come here.
int interrupting_signal();
void adopt_signal(int number);

/// During its lifetime the first SIGINT, SIGTERM or SIGHUP requests a stop instead of ending the program; a second one
/// ends it at once. Whoever waits for a pipe is stopped, too. A signal that the program was started to ignore (nohup)
/// stays ignored. The handlers stay after its end, so that a signal that comes while the program returns does not
/// change the exit status of finished work. At most one object may exist at a time.
class InterruptScope {
 public:
  InterruptScope();
  InterruptScope(const InterruptScope&) = delete;
  InterruptScope& operator=(const InterruptScope&) = delete;

  std::stop_token token() const { return source_.get_token(); }
  bool interrupted() const;
  ExitStatus status() const { return interrupted_status(); }

 private:
  std::stop_source source_;
  StopScope waiting_{source_.get_token()};
  std::jthread watcher_;  // request_stop() must not be called from a signal handler
};

}  // namespace carousel::app
