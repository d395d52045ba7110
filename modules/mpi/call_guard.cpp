#include "modules/mpi/call_guard.h"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <mutex>
#include <optional>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "ringbus/transport/transport.h"

namespace carousel::ringbus {

namespace {

namespace fs = std::filesystem;

// For ranks that start late, or on hosts of which the kernel here knows nothing.
constexpr std::chrono::seconds kLongestCall{120};

std::string content(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// The letter of a process's state, as of proc(5); it stands after the name, which may hold anything.
char state_letter(const fs::path& process) {
  const std::string stat = content(process / "stat");
  const std::size_t name_end = stat.rfind(')');
  return name_end == std::string::npos || name_end + 2 >= stat.size() ? '?' : stat[name_end + 2];
}

/// The value of a variable in an environment as the kernel gives it.
std::string_view variable(std::string_view environment, std::string_view name) {
  while (!environment.empty()) {
    const std::string_view entry = environment.substr(0, environment.find('\0'));
    environment.remove_prefix(std::min(environment.size(), entry.size() + 1));
    if (entry.size() > name.size() && entry.starts_with(name) && entry[name.size()] == '=')
      return entry.substr(name.size() + 1);
  }
  return {};
}

/// A rank of this run on this host that a signal has stopped.
std::optional<std::string> stopped_rank() {
  const char* const own_run = std::getenv("PMIX_NAMESPACE");
  if (own_run == nullptr) return std::nullopt;
  std::error_code ignored;
  for (const fs::directory_entry& process : fs::directory_iterator("/proc", ignored)) {
    if (process.path().filename().string().find_first_not_of("0123456789") != std::string::npos) continue;
    const char state = state_letter(process.path());
    if (state != 'T' && state != 't') continue;
    const std::string environment = content(process.path() / "environ");
    if (variable(environment, "PMIX_NAMESPACE") != own_run) continue;
    if (const std::string_view rank = variable(environment, "PMIX_RANK"); !rank.empty()) return std::string(rank);
  }
  return std::nullopt;
}

}  // namespace

CallGuard::CallGuard(std::string call, Say say)
    : watch_([call = std::move(call), say = std::move(say)](std::stop_token back) {
        using Clock = std::chrono::steady_clock;
        const Clock::time_point begin = Clock::now();
        std::optional<std::string> stopped;
        Clock::time_point since = begin;
        std::mutex mutex;
        std::condition_variable_any wake;
        const auto wait = [&](std::chrono::milliseconds time) {
          std::unique_lock lock(mutex);
          wake.wait_for(lock, back, time, [] { return false; });
          return !back.stop_requested();
        };
        while (wait(std::chrono::milliseconds(500))) {
          const Clock::time_point now = Clock::now();
          if (std::optional<std::string> found = stopped_rank(); found != stopped) {
            stopped = std::move(found);
            since = now;
          }
          if (stopped && now - since > kRankSilence)
            say(fmt::format("rank {} is stopped, and {} waits for it; it hangs", *stopped, call));
          else if (now - begin > kLongestCall)
            say(fmt::format("{} has waited for {} seconds; a rank on another host hangs or has not started", call,
                            kLongestCall.count()));
          else
            continue;
          // The other ranks of this host find it at the same time, and mpirun ends them with the first.
          if (wait(std::chrono::milliseconds(1500))) std::_Exit(1);
        }
      }) {}

}  // namespace carousel::ringbus
