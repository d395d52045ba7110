#pragma once

#include <functional>
#include <string>
#include <thread>

namespace carousel::ringbus {

/// Watches over a call of MPI's that waits for all ranks and cannot be polled: MPI_Init_thread, before which no rank
/// knows another, and MPI_Finalize, after which none may say a word. When a rank on this host is stopped all the while,
/// which the kernel tells, or when the call takes minutes, the process says so and ends with status 1; mpirun then ends
/// the others. A rank that only starts late is not stopped, and has those minutes.
class CallGuard {
 public:
  using Say = std::function<void(const std::string&)>;
  /// `call`: its name, for the message.
  CallGuard(std::string call, Say say);
  /// The call has come back.
  ~CallGuard() = default;
  CallGuard(const CallGuard&) = delete;
  CallGuard& operator=(const CallGuard&) = delete;

 private:
  std::jthread watch_;
};

}  // namespace carousel::ringbus
