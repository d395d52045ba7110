#include "app/host/output_folder.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <optional>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/config/differences.h"
#include "core/config/load.h"
#include "core/system/error.h"

namespace carousel::app {

namespace fs = std::filesystem;

namespace {

constexpr std::array<std::string_view, 6> kRunFiles{
    "report.json", "config.resolved.yaml", "report.html", "image.png", "image.exr", "hits.csv"};
constexpr const char* kConfigFile = "config.resolved.yaml";
constexpr const char* kReport = "report.json";

[[noreturn]] void fail(const fs::path& path, const std::string& why) {
  throw FileError("cannot write " + path.string() + ": " + why);
}

/// Moves a file or folder over another, in one step.
void move_to(const fs::path& from, const fs::path& to) {
  if (std::rename(from.c_str(), to.c_str()) != 0) fail(to, std::strerror(errno));
}

/// The configuration of the results in a folder; empty if there is none that can be read.
std::optional<Config> config_in(const fs::path& folder) {
  try {
    return load_config(read_config_file(folder / kConfigFile), {}, {.force = true}).config;
  } catch (const ConfigError&) {
    return std::nullopt;
  }
}

void refuse_other_results(const fs::path& folder, Config config) {
  std::error_code ignored;
  if (!fs::exists(folder / kReport, ignored) && !fs::exists(folder / kConfigFile, ignored)) return;
  std::string found = "the results of a configuration that cannot be read";
  if (std::optional<Config> there = config_in(folder)) {
    there->engine.threads = config.engine.threads;  // is the host's affair, and changes no result
    const std::vector<std::string> here = config_differences(*there, config);
    if (here.empty()) return;
    const std::vector<std::string> were = config_differences(config, *there);
    found = fmt::format("the results of another configuration, with {}{}, not {}",
                        were.empty() ? "other keys" : were.front(),
                        were.size() > 1 ? fmt::format(" and {} more differences", were.size() - 1) : "", here.front());
  }
  throw ConfigError({{{},
                      "--out",
                      fmt::format("{} holds {}; expected a folder of its own (--out DIR), or --force to replace them",
                                  folder.string(), found)}});
}

/// True if the folder holds nothing that is not a run's.
bool holds_only_run_files(const fs::path& folder) {
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    if (!entry.is_regular_file() || entry.is_symlink() || !is_run_file(entry.path().filename().string())) return false;
  return true;
}

/// True for the working folder: a user's shell would stay in the one that is taken away.
bool is_current(const fs::path& folder) {
  std::error_code error;
  return fs::equivalent(folder, fs::current_path(error), error);
}

}  // namespace

bool is_run_file(std::string_view name) {
  return std::find(kRunFiles.begin(), kRunFiles.end(), name) != kRunFiles.end();
}

OutputFolder::OutputFolder(const fs::path& folder, const Config& config, bool force) : folder_(folder) {
  std::error_code error;
  target_ = fs::weakly_canonical(fs::absolute(folder), error);
  if (error) fail(folder, error.message());
  if (!target_.has_filename()) target_ = target_.parent_path();
  const fs::file_status status = fs::status(target_, error);
  if (fs::exists(status) && !fs::is_directory(status)) fail(folder / "", "it is not a folder");
  if (!force) refuse_other_results(folder, config);
  const fs::path parent = target_.parent_path();
  make_parents();
  prefix_ = "." + target_.filename().string() + ".carousel-";
  if (fs::is_directory(status)) {
    if (access(target_.c_str(), W_OK | X_OK) != 0) fail(folder, std::strerror(errno));
    remove_left_overs(target_);
  }
  remove_left_overs(parent);
  if (make_staging(parent) || (fs::is_directory(status) && make_staging(target_))) return;
  const int why = errno;
  for (auto made = made_.rbegin(); made != made_.rend(); ++made) fs::remove(*made, error);
  fail(folder, std::strerror(why));
}

void OutputFolder::make_parents() {
  std::error_code error;
  std::vector<fs::path> missing;
  for (fs::path at = target_.parent_path(); !fs::exists(at, error); at = at.parent_path()) missing.push_back(at);
  for (auto at = missing.rbegin(); at != missing.rend(); ++at) {
    if (fs::create_directory(*at, error)) made_.push_back(*at);
    if (error) fail(folder_, error.message());
  }
}

OutputFolder::~OutputFolder() {
  std::error_code ignored;
  if (!staging_.empty()) fs::remove_all(staging_, ignored);
  if (lock_ >= 0) close(lock_);
  // Only folders that are empty are removed: a run that ended without a result leaves nothing.
  for (auto made = made_.rbegin(); made != made_.rend(); ++made) fs::remove(*made, ignored);
}

/// Makes the hidden folder in the folder `in`, and locks it. A lock ends with its process, however that ends.
bool OutputFolder::make_staging(const fs::path& in) {
  std::string name = (in / (prefix_ + "XXXXXX")).string();
  if (mkdtemp(name.data()) == nullptr) return false;
  staging_ = name;
  const int lock = open(name.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (lock < 0 || flock(lock, LOCK_EX | LOCK_NB) != 0) {
    const int why = errno;
    if (lock >= 0) close(lock);
    std::error_code ignored;
    fs::remove_all(std::exchange(staging_, {}), ignored);
    errno = why;
    return false;
  }
  lock_ = lock;
  const mode_t mask = umask(0);
  umask(mask);
  std::error_code ignored;
  fs::permissions(staging_, static_cast<fs::perms>(0777 & ~mask), ignored);  // mkdtemp makes it private
  return true;
}

void OutputFolder::remove_left_overs(const fs::path& in) const {
  std::error_code error;
  for (fs::directory_iterator at(in, error), end; !error && at != end; at.increment(error)) {
    std::error_code ignored;
    if (!at->path().filename().string().starts_with(prefix_) || !at->is_directory(ignored)) continue;
    const int lock = open(at->path().c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    if (lock < 0) continue;
    if (flock(lock, LOCK_EX | LOCK_NB) == 0) fs::remove_all(at->path(), ignored);  // no run holds it any more
    close(lock);
  }
}

/// Moves the files one by one, the report last: where there is a report, all that belongs to it is there.
void OutputFolder::move_each() const {
  std::error_code error;
  fs::remove(target_ / kReport, error);
  for (const std::string_view name : kRunFiles)
    if (!fs::exists(staging_ / name, error)) fs::remove(target_ / name, error);
  bool report = false;
  std::vector<fs::path> names;
  for (const fs::directory_entry& entry : fs::directory_iterator(staging_)) names.push_back(entry.path().filename());
  for (const fs::path& name : names) {
    if (name == kReport)
      report = true;
    else
      move_to(staging_ / name, target_ / name);
  }
  if (report) move_to(staging_ / kReport, target_ / kReport);
}

void OutputFolder::commit() {
  try {
    const bool beside = staging_.parent_path() == target_.parent_path();
    if (!fs::exists(target_) && beside) {
      move_to(staging_, target_);
      staging_.clear();
    } else if (beside && holds_only_run_files(target_) && !is_current(target_) &&
               renameat2(AT_FDCWD, staging_.c_str(), AT_FDCWD, target_.c_str(), RENAME_EXCHANGE) == 0) {
      // staging_ is now the old folder, which the destructor removes.
    } else {
      fs::create_directories(target_);
      move_each();
    }
  } catch (const fs::filesystem_error& error) {
    fail(folder_, error.code().message());
  }
}

}  // namespace carousel::app
