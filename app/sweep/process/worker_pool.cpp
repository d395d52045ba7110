#include "app/sweep/process/worker_pool.h"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>

#include <fmt/format.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/system/error.h"

namespace carousel::app {

using Json = nlohmann::ordered_json;

WorkerPool::~WorkerPool() {
  for (Host& host : hosts_) kill(host.process.pid, SIGKILL);  // its points end with it
  while (!hosts_.empty()) end_host(hosts_.size() - 1);
}

std::size_t WorkerPool::slots(const SweepPoint& point) const {
  return std::clamp<std::size_t>(point.threads, 1, jobs_);
}

void WorkerPool::add(SweepPoint point) {
  auto& line = waiting_[point.group];
  if (line.empty()) groups_.push_back(point.group);
  line.push_back(next_id_);
  points_.emplace(next_id_++, std::move(point));
  ++waiting_count_;
}

WorkerPool::Host& WorkerPool::start_host(const std::string& group) {
  std::vector<int> close_these;
  for (const Host& host : hosts_) close_these.push_back(host.process.socket);
  const SweepPoint& first = points_.at(waiting_.at(group).front());
  const std::size_t build_threads = std::max<std::size_t>(1, jobs_ / std::min(jobs_, groups_.size()));
  const SceneHost process = start_scene_host(setup_, first, build_threads, close_these);
  hosts_.push_back({process, group, false, {}});
  return hosts_.back();
}

/// The host of the next point: one that holds its scene already, or else a new one, or else one that is still building.
/// The memory holds at most as many scenes as points run at once.
WorkerPool::Host* WorkerPool::choose_host() {
  const auto has_work = [&](const Host& host) { return waiting_.count(host.group) > 0; };
  for (Host& host : hosts_)
    if (host.ready && has_work(host)) return &host;
  for (const std::string& group : groups_) {
    const bool held = std::any_of(hosts_.begin(), hosts_.end(), [&](const Host& h) { return h.group == group; });
    if (held) continue;
    if (hosts_.size() >= jobs_) end_idle_hosts();
    if (hosts_.size() < jobs_) return &start_host(group);
  }
  for (Host& host : hosts_)
    if (has_work(host)) return &host;
  return nullptr;
}

std::optional<std::uint64_t> WorkerPool::start_one() {
  if (waiting_count_ == 0 || used_ >= jobs_) return std::nullopt;
  Host* host = choose_host();
  if (host == nullptr) return std::nullopt;
  auto& line = waiting_.at(host->group);
  const std::uint64_t id = line.front();
  const SweepPoint& point = points_.at(id);
  if (used_ + slots(point) > jobs_) return std::nullopt;
  Json keys = Json::array();
  for (const KeyValue& key : point.keys) keys.push_back(Json::array({key.first, key.second}));
  const Json order{{"id", id}, {"keys", keys}, {"sets", point.sets}, {"digest", point.digest}};
  // A host that has just died is noticed by the end of its socket, with the points that it was given.
  send_message(host->process.socket, order.dump(-1, ' ', false, Json::error_handler_t::replace));
  line.pop_front();
  if (line.empty()) {
    waiting_.erase(host->group);
    groups_.erase(std::find(groups_.begin(), groups_.end(), host->group));
  }
  host->running.push_back(id);
  used_ += slots(point);
  --waiting_count_;
  ++running_count_;
  return id;
}

std::vector<std::uint64_t> WorkerPool::start_more() {
  std::vector<std::uint64_t> out;
  while (const auto id = start_one()) out.push_back(*id);
  return out;
}

void WorkerPool::end_host(std::size_t index) {
  close(hosts_[index].process.socket);
  while (waitpid(hosts_[index].process.pid, nullptr, 0) < 0 && errno == EINTR) continue;
  hosts_.erase(hosts_.begin() + static_cast<std::ptrdiff_t>(index));
}

void WorkerPool::end_idle_hosts() {
  for (std::size_t i = hosts_.size(); i-- > 0;)
    if (hosts_[i].running.empty() && waiting_.count(hosts_[i].group) == 0) end_host(i);
}

std::vector<WorkerPool::Finished> WorkerPool::wait(int timeout_ms, int also) {
  std::vector<pollfd> fds;
  for (const Host& host : hosts_) fds.push_back({host.process.socket, POLLIN, 0});
  if (also >= 0) fds.push_back({also, POLLIN, 0});
  std::vector<Finished> out;
  if (poll(fds.data(), fds.size(), timeout_ms) <= 0) return out;
  for (std::size_t i = hosts_.size(); i-- > 0;)
    if (fds[i].revents != 0) on_worker(i, out);
  return out;
}

WorkerPool::Finished WorkerPool::finish(std::uint64_t id, double seconds, std::optional<PointError> error) {
  Finished out{std::move(points_.at(id)), seconds, std::move(error)};
  points_.erase(id);
  return out;
}

void WorkerPool::on_worker(std::size_t index, std::vector<Finished>& out) {
  Host& host = hosts_[index];
  const std::string text = receive_message(host.process.socket);
  if (text.empty()) return host_ended(index, out);
  const Json message = Json::parse(text);
  const auto error_of = [](const Json& json) -> std::optional<PointError> {
    if (json.is_null()) return std::nullopt;
    return PointError{json.at("kind"), json.at("text")};
  };
  if (message.contains("ready")) {
    host.ready = true;
    return;
  }
  std::vector<std::uint64_t> over;
  std::optional<PointError> error;
  double seconds = 0;
  if (message.contains("broken")) {
    error = error_of(message["broken"]);
    over = host.running;
    // A configuration can be wrong for the first point alone; another error is that of the scene.
    if (error->kind == "config") over.resize(1);
    if (const auto line = waiting_.find(host.group); error->kind != "config" && line != waiting_.end()) {
      for (const std::uint64_t id : line->second) out.push_back(finish(id, 0, error));
      waiting_count_ -= line->second.size();
      groups_.erase(std::find(groups_.begin(), groups_.end(), host.group));
      waiting_.erase(line);
    }
  } else {
    over = {message.at("id").get<std::uint64_t>()};
    seconds = message.at("seconds");
    error = error_of(message.at("error"));
  }
  for (const std::uint64_t id : over) {
    std::erase(host.running, id);
    used_ -= slots(points_.at(id));
    --running_count_;
    out.push_back(finish(id, seconds, error));
  }
}

/// The points that a host had begun end with it; after an error of the first one the others were not begun.
void WorkerPool::host_ended(std::size_t index, std::vector<Finished>& out) {
  Host host = std::move(hosts_[index]);
  hosts_.erase(hosts_.begin() + static_cast<std::ptrdiff_t>(index));
  close(host.process.socket);
  int status = 0;
  while (waitpid(host.process.pid, &status, 0) < 0 && errno == EINTR) continue;
  for (const std::uint64_t id : host.running) {
    used_ -= slots(points_.at(id));
    --running_count_;
    if (WIFSIGNALED(status)) {
      const std::string text = fmt::format("the process that held the scene was ended by signal {} ({})",
                                           WTERMSIG(status), strsignal(WTERMSIG(status)));
      out.push_back(finish(id, 0, PointError{"signal", text}));
      continue;
    }
    auto& line = waiting_[host.group];
    if (line.empty()) groups_.push_back(host.group);
    line.push_back(id);
    ++waiting_count_;
  }
}

}  // namespace carousel::app
