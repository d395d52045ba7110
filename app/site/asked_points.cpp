#include "app/site/asked_points.h"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <fstream>
#include <iterator>
#include <optional>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "app/sweep/process/point_file.h"
#include "app/sweep/results.h"
#include "core/numeric/bytes_digest.h"
#include "core/system/atomic_file.h"
#include "core/system/error.h"
#include "report/read/document.h"

namespace carousel::app {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

HttpAnswer told(int status, const Json& json) {
  return {status, "application/json", json.dump() + "\n"};
}
HttpAnswer wrong(const std::string& why) {
  return {400, "text/plain; charset=utf-8", why + "\n"};
}

/// The values of a key over the points of a sweep.
std::vector<Json> values_of(const Json& sweep, const std::string& key) {
  std::vector<Json> out;
  for (const Json& point : sweep["points"])
    if (const auto value = point["keys"].find(key); value != point["keys"].end()) out.push_back(*value);
  return out;
}

/// What is wrong with a value that is asked for, if anything.
std::optional<std::string> fault_of(const Json& sweep, const std::string& key, const std::string& text) {
  const std::vector<Json> values = values_of(sweep, key);
  if (values.empty()) return key + ": is no key of this sweep";
  const Json asked = value_json(text);
  const bool numbers = std::all_of(values.begin(), values.end(), [](const Json& v) { return v.is_number(); });
  if (!numbers) {
    if (std::find(values.begin(), values.end(), asked) != values.end()) return std::nullopt;
    return key + ": expected one of the sweep's values";
  }
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  const bool whole = std::all_of(values.begin(), values.end(), [](const Json& v) { return v.is_number_integer(); });
  if (asked.is_number() && (!whole || asked.is_number_integer()) && asked >= *least && asked <= *most)
    return std::nullopt;
  return fmt::format("{}: expected {} from {} to {}", key, whole ? "an integer" : "a number", least->dump(),
                     most->dump());
}

/// The configuration of some point of the sweep, to which the keys are added; null if none has one.
Json base_config(const fs::path& folder, const Json& sweep) {
  for (const Json& point : sweep["points"]) {
    if (point["status"] != "done") continue;
    const std::optional<PointFile> file = read_point(point_path(folder, point["point"].get<std::string>()));
    if (file && file->report.contains("config")) return file->report["config"];
  }
  return nullptr;
}

/// A sweep of strangers must not have the server load code of theirs.
bool has_plugins(const Json& config) {
  const auto engine = config.find("engine");
  if (engine == config.end() || !engine->is_object()) return false;
  const auto plugins = engine->find("plugins");
  return plugins != engine->end() && !plugins->empty();
}

/// The results of the sweep, of a report.
Json results_of(const Json& sweep, const Json& report) {
  std::vector<ResultColumn> columns = result_columns({});
  std::vector<std::string> paths;
  const auto known = [&](const Json& name) {
    return std::any_of(columns.begin(), columns.end(), [&](const ResultColumn& c) { return c.name == name; });
  };
  for (const Json& name : sweep["results"])
    if (!known(name)) paths.push_back(name.get<std::string>());
  columns = result_columns(paths);
  Json out = Json::object();
  for (const ResultColumn& column : columns) out[column.name] = result_of(column, report);
  return out;
}

/// The report of a run that came to its end; that of an interrupted one is no result of the point.
std::optional<Json> whole_report(const fs::path& run) {
  std::error_code error;
  if (!fs::exists(run / "report.json", error)) return std::nullopt;
  Json report = report::read_document(run / "report.json").json;
  return report.value("incomplete", false) ? std::nullopt : std::optional(std::move(report));
}

std::string text_in(const fs::path& file) {
  constexpr std::size_t kMost = 2000;
  std::ifstream in(file);
  return std::string(std::istreambuf_iterator<char>(in), {}).substr(0, kMost);
}

bool is_of_plugins(const std::string& key) {
  return key.starts_with("engine.plugins");
}

bool is_name(const std::string& name) {
  return name.size() == 32 && name.find_first_not_of("0123456789abcdef") == name.npos;
}

fs::path with_ending(const fs::path& run, const char* ending) {
  return run.parent_path() / (run.filename().string() + ending);
}

}  // namespace

AskedPoints::~AskedPoints() {
  {
    const std::scoped_lock lock(mutex_);
    if (process_ > 0) kill(process_, SIGTERM);
  }
  if (waits_.joinable()) waits_.join();
}

HttpAnswer AskedPoints::start(const fs::path& folder, const std::vector<std::pair<std::string, std::string>>& keys) {
  const Json sweep = report::read_document(folder / "sweep.json").json;
  std::vector<std::string> words{"run"}, names;
  std::string all;
  for (const auto& [key, value] : keys) {
    if (const auto fault = fault_of(sweep, key, value)) return wrong(*fault);
    if (std::find(names.begin(), names.end(), key) != names.end()) return wrong(key + ": expected once");
    names.push_back(key);
    all += key + "=" + value + "\n";
  }
  for (const Json& key : sweep["keys"])
    if (std::find(names.begin(), names.end(), key) == names.end())
      return wrong(key.get<std::string>() + ": expected a value, found none");
  if (std::find(names.begin(), names.end(), "scene") != names.end())
    return wrong("scene: a sweep over scenes cannot be asked for a point");
  const std::string name = bytes_digest(all);
  const fs::path run = folder / "asked" / name;
  std::error_code error;
  const std::scoped_lock lock(mutex_);
  if (running_ == run || whole_report(run)) return told(202, {{"name", name}});
  if (!running_.empty()) return {409, "text/plain; charset=utf-8", "another point is being simulated; ask again\n"};
  const Json config = base_config(folder, sweep);
  if (!config.is_object()) return wrong("no point of this sweep has a configuration to begin with");
  if (has_plugins(config) || std::any_of(names.begin(), names.end(), is_of_plugins))
    return wrong("engine.plugins: a sweep with plugins is run by hand");
  fs::create_directory(folder / "asked", error);
  if (error || fs::is_symlink(folder / "asked", error) || !fs::is_directory(folder / "asked", error) ||
      fs::is_symlink(run, error))
    return wrong("asked: expected a folder in that of the sweep");
  const fs::path file = with_ending(run, ".config.json");
  write_file(file, config.dump(1) + "\n");
  words.push_back(file.string());
  for (const auto& [key, value] : keys) words.insert(words.end(), {"--set", key + "=" + value});
  words.insert(words.end(), {"--out", run.string(), "--force", "--quiet"});
  this->run(folder, name, std::move(words));
  return told(202, {{"name", name}});
}

/// The lock is held.
void AskedPoints::run(const fs::path& folder, const std::string& name, std::vector<std::string> words) {
  const fs::path run = folder / "asked" / name;
  const std::string program = fs::read_symlink("/proc/self/exe").string(), told_in = with_ending(run, ".log").string();
  words.insert(words.begin(), program);
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&actions, 2, told_in.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_NOFOLLOW, 0644);
  // The threads of a server may hold signals back, which the run has to hear.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;
  sigemptyset(&none);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);
  pid_t process = 0;
  const int failed = posix_spawn(&process, program.c_str(), &actions, &attributes, arguments.data(), environ);
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (failed != 0) throw FileError(fmt::format("cannot start {}: {}", program, std::strerror(failed)));
  running_ = run;
  process_ = process;
  // The thread before has nothing left to wait for, since no run goes on.
  waits_ = std::jthread([this, process] {
    siginfo_t info{};
    while (waitid(P_PID, static_cast<id_t>(process), &info, WEXITED | WNOWAIT) < 0 && errno == EINTR) continue;
    const std::scoped_lock lock(mutex_);
    waitpid(process, nullptr, 0);
    process_ = 0;
    running_.clear();
  });
}

HttpAnswer AskedPoints::state(const fs::path& folder, const std::string& name) {
  const HttpAnswer none{404, "text/plain; charset=utf-8", "not found\n"};
  if (!is_name(name)) return none;
  const fs::path run = folder / "asked" / name;
  {
    const std::scoped_lock lock(mutex_);
    if (running_ == run) return told(200, {{"state", "running"}});
  }
  std::error_code error;
  if (fs::weakly_canonical(run, error) != run) return none;
  if (const std::optional<Json> report = whole_report(run)) {
    const Json sweep = report::read_document(folder / "sweep.json").json;
    return told(200, {{"state", "done"}, {"results", results_of(sweep, *report)}, {"page", "asked/" + name + "/"}});
  }
  if (!fs::exists(with_ending(run, ".log"), error)) return none;
  const std::string log = text_in(with_ending(run, ".log"));
  return told(200, {{"state", "failed"}, {"error", log.empty() ? "the run was interrupted; ask again" : log}});
}

}  // namespace carousel::app
