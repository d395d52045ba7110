#include "core/module/module_process.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <exception>
#include <new>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/module/module.h"
#include "core/system/plain_text.h"
#include "core/system/stop_request.h"

namespace carousel {

namespace {

// Before its bytes each message says how many there are, and an answer also of which kind it is.
enum class Kind : std::uint8_t { kAnswer, kRefusal, kNoModule };
struct Head {
  std::uint64_t bytes = 0;
  Kind kind = Kind::kAnswer;
};

constexpr unsigned kSeconds = 300;
constexpr int kStandardInput = 0;

bool read_all(int from, void* into, std::size_t size) {
  for (auto* at = static_cast<char*>(into); size > 0;) {
    const ssize_t count = recv(from, at, size, 0);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    at += count;
    size -= static_cast<std::size_t>(count);
  }
  return true;
}

/// MSG_NOSIGNAL: the other side may have died.
bool write_all(int to, const void* from, std::size_t size) {
  for (auto* at = static_cast<const char*>(from); size > 0;) {
    const ssize_t count = ::send(to, at, size, MSG_NOSIGNAL);
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return false;
    at += count;
    size -= static_cast<std::size_t>(count);
  }
  return true;
}

/// Gives the process so many more seconds of the processor, counted over all its threads, for a question of `bytes`. A
/// library that loops over a damaged file ends with SIGXCPU. A module may set another limit.
void limit_work(std::uint64_t bytes) {
  constexpr std::uint64_t kLeast = 10, kOfMiB = 4;
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  rlimit limit{};
  getrlimit(RLIMIT_CPU, &limit);
  const auto spent = static_cast<std::uint64_t>(used.ru_utime.tv_sec + used.ru_stime.tv_sec);
  limit.rlim_cur = std::min<rlim_t>(spent + 1 + kLeast + kOfMiB * (bytes >> 20), limit.rlim_max);
  setrlimit(RLIMIT_CPU, &limit);
}

bool reply(Kind kind, std::string_view text) {
  const Head head{text.size(), kind};
  return write_all(kStandardInput, &head, sizeof head) && write_all(kStandardInput, text.data(), text.size());
}

}  // namespace

void ModuleProcess::start() {
  const std::string folder = module_file(module_).parent_path().string();
  const std::string program = folder + "/process";
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0)
    throw ModuleError(fmt::format("cannot make a socket: {}", std::strerror(errno)));
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, ends[1], kStandardInput);
  // A library that breaks prints messages of its own, which are not the program's.
  for (const int output : {1, 2}) posix_spawn_file_actions_addopen(&actions, output, "/dev/null", O_WRONLY, 0);
  std::array<char*, 4> argv{const_cast<char*>(program.c_str()), const_cast<char*>(folder.c_str()), module_.data(),
                            nullptr};
  const int error = posix_spawn(&child_, program.c_str(), &actions, nullptr, argv.data(), environ);
  posix_spawn_file_actions_destroy(&actions);
  close(ends[1]);
  if (error != 0) {
    close(ends[0]);
    throw ModuleError(fmt::format("cannot start {}: {}", program, std::strerror(error)));
  }
  socket_ = ends[0];
  owner_ = getpid();
}

/// Returns the status of the process, as waitpid() gives it.
int ModuleProcess::end() {
  if (socket_ >= 0) close(std::exchange(socket_, -1));
  int status = 0;
  const bool own = owner_ == getpid();
  owner_ = 0;
  if (!own) return status;
  kill(child_, SIGKILL);
  while (waitpid(child_, &status, 0) < 0 && errno == EINTR) continue;
  return status;
}

void ModuleProcess::died() {
  // It has closed its end, and is about to be a zombie: its own status tells more than our signal.
  siginfo_t info{};
  for (int wait = 0; wait < 100 && info.si_pid == 0; ++wait) {
    waitid(P_PID, static_cast<id_t>(child_), &info, WEXITED | WNOWAIT | WNOHANG);
    if (info.si_pid == 0) poll(nullptr, 0, 10);
  }
  const int status = end();
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM)
    throw std::runtime_error(fmt::format("broken: the module {} took more than {} seconds over it", module_, kSeconds));
  throw std::runtime_error(fmt::format("broken: the module {} broke down over it ({})", module_,
                                       WIFSIGNALED(status) ? std::string(strsignal(WTERMSIG(status)))
                                                           : fmt::format("exit status {}", WEXITSTATUS(status))));
}

void ModuleProcess::send(std::string_view bytes) {
  if (!write_all(socket_, bytes.data(), bytes.size())) died();
}

bool ModuleProcess::receive(void* into, std::size_t size) {
  wait_for(socket_, POLLIN, "the module " + module_);
  return read_all(socket_, into, size);
}

std::vector<unsigned char> ModuleProcess::ask(std::span<const std::string_view> question,
                                              const std::function<void(std::uint64_t bytes)>& take) {
  if (owner_ != getpid()) {
    end();
    start();
  }
  try {
    Head head;
    for (const std::string_view part : question) head.bytes += part.size();
    send({reinterpret_cast<const char*>(&head), sizeof head});
    for (const std::string_view part : question) send(part);
    if (!receive(&head, sizeof head)) died();
    if (head.kind == Kind::kAnswer) take(head.bytes);
    std::vector<unsigned char> out(head.bytes);
    if (!read_all(socket_, out.data(), out.size())) died();
    const auto text = [&] { return plain_text({reinterpret_cast<const char*>(out.data()), out.size()}); };
    if (head.kind == Kind::kNoModule) throw ModuleError(text());
    if (head.kind == Kind::kRefusal) throw std::runtime_error(text());
    return out;
  } catch (const ModuleError&) {
    end();
    throw;
  } catch (const std::runtime_error& error) {
    if (dynamic_cast<const Interrupted*>(&error) != nullptr) end();
    throw;
  } catch (...) {
    end();  // in the midst of an answer
    throw;
  }
}

int serve_module(const std::string& name) {
  // The program decides what an interruption means, and ends this process.
  for (const int number : {SIGINT, SIGHUP, SIGTERM}) std::signal(number, SIG_IGN);
  const ModuleInfo* module = nullptr;
  for (Head head; read_all(kStandardInput, &head, sizeof head);) {
    alarm(kSeconds);
    std::string question;
    bool going = true;
    try {
      question.resize(head.bytes);
      if (!read_all(kStandardInput, question.data(), question.size())) return 0;
      if (module == nullptr) module = &open_module(name);
      limit_work(question.size());
      going = reply(Kind::kAnswer, module->answer(question));
    } catch (const ModuleError& error) {
      reply(Kind::kNoModule, error.what());
      return 2;
    } catch (const std::bad_alloc&) {
      going = reply(Kind::kRefusal, "broken, or needs more memory than there is");
    } catch (const std::exception& error) {
      going = reply(Kind::kRefusal, error.what());
    }
    if (!going) return 0;
    alarm(0);
  }
  return 0;
}

}  // namespace carousel
