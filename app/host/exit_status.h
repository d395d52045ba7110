#pragma once

namespace carousel::app {

/// The exit statuses, a contract (docs/how-it-works/design.md, Exit statuses).
enum ExitStatus : int {
  kDone = 0,
  kBroken = 1,         ///< an invariant broke, a simulation got stuck, a verification failed
  kUsage = 2,          ///< bad usage, config, scene or file; check: also a topology that can deadlock
  kHungUp = 129,       ///< by SIGHUP
  kInterrupted = 130,  ///< by SIGINT; a partial report is marked incomplete
  kTerminated = 143,   ///< by SIGTERM
};

}  // namespace carousel::app
