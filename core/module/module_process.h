#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <sys/types.h>

namespace carousel {

/// A process of its own in which a module works on data of strangers: a library that trips over a damaged file takes
/// that process with it, and not the program. It is started with the first question (to open a large library takes a
/// good part of a second), answers one after another, and ends with the object or with the program. Not for several
/// threads at once. After fork() each process has one of its own.
class ModuleProcess {
 public:
  explicit ModuleProcess(std::string module) : module_(std::move(module)) {}
  ~ModuleProcess() { end(); }
  ModuleProcess(const ModuleProcess&) = delete;
  ModuleProcess& operator=(const ModuleProcess&) = delete;

  /// What ModuleInfo::answer of the module says to the parts of a question, put together. `take` is asked before memory
  /// for so many bytes of the answer is allocated, and may throw. Throws ModuleError where the module is missing or
  /// refused; std::runtime_error with the reason where answer() threw, or where the process died, or took more than
  /// five minutes, or than ten seconds of the processor and four for each MiB of the question; and Interrupted.
  std::vector<unsigned char> ask(std::span<const std::string_view> question,
                                 const std::function<void(std::uint64_t bytes)>& take);

 private:
  void start();
  int end();
  void send(std::string_view bytes);
  bool receive(void* into, std::size_t size);
  [[noreturn]] void died();

  std::string module_;
  pid_t owner_ = 0, child_ = 0;
  int socket_ = -1;
};

/// The other side: answers questions on standard input until it ends. Returns the exit status.
int serve_module(const std::string& name);

}  // namespace carousel
