#include "app/host/starved.h"

#include <cstdlib>
#include <exception>
#include <new>
#include <string_view>
#include <system_error>

#include <unistd.h>

#include "app/host/exit_status.h"

namespace carousel::app {

namespace {

[[noreturn]] void end(std::string_view message) {
  // No stream: they may not be there yet.
  static_cast<void>(!write(STDERR_FILENO, message.data(), message.size()));
  _exit(kUsage);
}

[[noreturn]] void on_terminate() {
  if (const std::exception_ptr error = std::current_exception()) {
    try {
      std::rethrow_exception(error);
    } catch (const std::bad_alloc&) {
      end("error: not enough memory or address space (ulimit -v)\n");
    } catch (const std::system_error& failure) {
      if (failure.code() == std::errc::resource_unavailable_try_again)
        end("error: cannot start a thread: not enough memory, address space or processes (ulimit -v, ulimit -u)\n");
    } catch (...) {
    }
  }
  __gnu_cxx::__verbose_terminate_handler();
  __gnu_cxx::__verbose_terminate_handler();
  std::abort();
}

}  // namespace

void explain_starvation() {
  std::set_terminate(on_terminate);
}

}  // namespace carousel::app
