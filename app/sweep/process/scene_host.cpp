#include "app/sweep/process/scene_host.h"

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <new>
#include <optional>

#include <fmt/format.h>
#include <poll.h>
#include <spdlog/spdlog.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <tbb/global_control.h>
#include <unistd.h>

#include "core/system/error.h"

namespace carousel::app {

namespace {

using Json = nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kMostMessage = 1 << 16;
constexpr std::size_t kMostErrorText = 1 << 13;

/// The kernel ends this process when the one that forked it ends, however that ends.
void die_with_parent(pid_t parent) {
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (getppid() != parent) _exit(0);  // it died before
}

Json error_json(const PointError& error) {
  return {{"kind", error.kind}, {"text", error.text.substr(0, kMostErrorText)}};
}

std::string text_of(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

/// Loads the scene of the group. The threads of the build are gone when it returns, since a forked process would not
/// have them.
Prepared load_group(const SweepSetup& setup, const SweepPoint& first, std::size_t build_threads) {
  tbb::task_scheduler_handle handle{tbb::attach{}};
  ConfigArguments arguments{setup.config.string(), first.sets};
  arguments.sets.push_back(fmt::format("engine.threads={}", build_threads));
  Prepared prepared = prepare(arguments, {.searches = true}, false);
  tbb::finalize(handle, std::nothrow);
  if (scene_group(prepared.config()) != first.group)
    throw FileError(setup.config.string() + " was changed while the sweep ran");
  return prepared;
}

struct Child {
  pid_t pid = -1;
  int pipe = -1;  ///< brings the error, and its end when the child ends
  std::uint64_t id = 0;
  Clock::time_point start;
  std::string said;
};

class Host {
 public:
  Host(const SweepSetup& setup, int socket) : setup_(setup), socket_(socket) {}

  [[noreturn]] void serve(const SweepPoint& first, std::size_t build_threads) {
    try {
      prepared_.emplace(load_group(setup_, first, build_threads));
    } catch (...) {
      send_message(socket_, text_of({{"broken", error_json(current_error())}}));
      _exit(1);
    }
    send_message(socket_, text_of({{"ready", true}}));
    for (;;) step();
  }

 private:
  void step() {
    std::vector<pollfd> fds{{socket_, POLLIN, 0}};
    for (const Child& child : children_) fds.push_back({child.pipe, POLLIN, 0});
    if (poll(fds.data(), fds.size(), -1) < 0) return;
    for (std::size_t i = children_.size(); i-- > 0;)
      if (fds[i + 1].revents != 0) on_worker(i);
    if (fds[0].revents == 0) return;
    const std::string message = receive_message(socket_);
    if (message.empty()) _exit(0);  // the children end with their parent
    start(Json::parse(message));
  }

  void start(const Json& order) {
    SweepPoint point;
    for (const Json& key : order["keys"]) point.keys.emplace_back(key[0], key[1]);
    point.sets = order["sets"].get<std::vector<std::string>>();
    point.digest = order["digest"];
    int ends[2];
    if (pipe(ends) != 0) return fail(order["id"], errno);
    Child child{-1, ends[0], order["id"], Clock::now(), ""};
    const pid_t self = getpid();
    child.pid = fork();
    if (child.pid == 0) {
      die_with_parent(self);
      close(socket_);
      run(point, ends[1]);
    }
    close(ends[1]);
    if (child.pid < 0) {
      close(ends[0]);
      return fail(order["id"], errno);
    }
    children_.push_back(std::move(child));
  }

  [[noreturn]] void run(const SweepPoint& point, int out) {
    spdlog::set_level(spdlog::level::off);  // the coordinator tells what went wrong
    if (const std::optional<PointError> error = run_point(setup_, *prepared_, point)) {
      const std::string text = text_of(error_json(*error));
      if (write(out, text.data(), text.size()) < 0) _exit(3);
    }
    _exit(0);  // the memory is shared with the parent: to take it down in order would copy it
  }

  void fail(std::uint64_t id, int number) {
    const PointError error{"file", std::string("cannot start a process: ") + std::strerror(number)};
    send_message(socket_, text_of({{"id", id}, {"seconds", 0}, {"error", error_json(error)}}));
  }

  /// Reads what a child says, and tells its end to the coordinator.
  void on_worker(std::size_t index) {
    Child& child = children_[index];
    char buffer[4096];
    const ssize_t count = read(child.pipe, buffer, sizeof buffer);
    if (count > 0) {
      child.said.append(buffer, static_cast<std::size_t>(count));
      return;
    }
    if (count < 0 && errno == EINTR) return;
    close(child.pipe);
    int status = 0;
    while (waitpid(child.pid, &status, 0) < 0 && errno == EINTR) continue;
    Json error;
    if (!child.said.empty()) error = Json::parse(child.said, nullptr, false);
    if (error.is_discarded()) error = nullptr;
    if (WIFSIGNALED(status)) {
      const int number = WTERMSIG(status);
      error = error_json({"signal", fmt::format("its process was ended by signal {} ({})", number, strsignal(number))});
    } else if (WEXITSTATUS(status) != 0 && error.is_null()) {
      error = error_json({"exit", fmt::format("its process ended with exit status {}", WEXITSTATUS(status))});
    }
    const std::chrono::duration<double> seconds = Clock::now() - child.start;
    send_message(socket_, text_of({{"id", child.id}, {"seconds", seconds.count()}, {"error", error}}));
    children_.erase(children_.begin() + static_cast<std::ptrdiff_t>(index));
  }

  const SweepSetup& setup_;
  int socket_;
  std::optional<Prepared> prepared_;
  std::vector<Child> children_;
};

}  // namespace

bool send_message(int socket, const std::string& text) {
  ssize_t sent;
  while ((sent = send(socket, text.data(), text.size(), MSG_NOSIGNAL)) < 0 && errno == EINTR) continue;
  return sent == static_cast<ssize_t>(text.size());
}

std::string receive_message(int socket) {
  std::string out(kMostMessage, '\0');
  ssize_t count;
  while ((count = recv(socket, out.data(), out.size(), 0)) < 0 && errno == EINTR) continue;
  out.resize(static_cast<std::size_t>(std::max<ssize_t>(count, 0)));
  return out;
}

SceneHost start_scene_host(const SweepSetup& setup, const SweepPoint& first, std::size_t build_threads,
                           const std::vector<int>& close_these) {
  int ends[2];
  if (socketpair(AF_UNIX, SOCK_SEQPACKET, 0, ends) != 0)
    throw FileError(std::string("cannot make a socket: ") + std::strerror(errno));
  const pid_t self = getpid();
  const pid_t pid = fork();
  if (pid < 0) {
    const int number = errno;
    close(ends[0]);
    close(ends[1]);
    throw FileError(std::string("cannot start a process: ") + std::strerror(number));
  }
  if (pid == 0) {
    die_with_parent(self);
    for (const int number : {SIGINT, SIGTERM, SIGHUP}) std::signal(number, SIG_IGN);  // the coordinator decides
    for (const int descriptor : close_these) close(descriptor);
    close(ends[0]);
    Host(setup, ends[1]).serve(first, build_threads);
  }
  close(ends[1]);
  return {pid, ends[0]};
}

}  // namespace carousel::app
