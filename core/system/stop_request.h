#pragma once

#include <stdexcept>
#include <stop_token>
#include <string>

namespace carousel {

/// A signal asked the program to stop before it had a result; the text says how far it had come. Exit status 128 plus
/// the number of the signal.
class Interrupted : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// While it lives, whoever waits in this process for something outside of it (wait_for) stops waiting when a stop is
/// requested. One at a time.
class StopScope {
 public:
  explicit StopScope(std::stop_token token);
  ~StopScope();
  StopScope(const StopScope&) = delete;
  StopScope& operator=(const StopScope&) = delete;
};

/// Throws Interrupted if a stop has been requested; `what` was waited for.
void throw_if_stopped(const std::string& what);

/// Waits until a descriptor can be read (POLLIN) or written (POLLOUT), or has nobody at its other end. Files never have
/// to be waited for; pipes and terminals do. Throws Interrupted.
void wait_for(int descriptor, short events, const std::string& what);

}  // namespace carousel
