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
#include "core/config/load/load.h"
#include "core/system/error.h"

namespace carousel::app {

namespace fs = std::filesystem;

namespace {

constexpr const char* kConfigFile = "config.resolved.yaml";  // all commands write it

/// The files of a command, by Results; the first is its result, which appears last.
constexpr std::array<std::array<std::string_view, 5>, 3> kFiles{{
    {"report.json", "report.html", "image.png", "image.exr", "hits.csv"},
    {"accuracy.json", "accuracy.html"},
    {"stress.json", "stress.html"},
}};

std::string_view result_of(Results results) {
  return kFiles[static_cast<std::size_t>(results)].front();
}

bool is_file_of(Results results, std::string_view name) {
  const auto& files = kFiles[static_cast<std::size_t>(results)];
  return !name.empty() && std::find(files.begin(), files.end(), name) != files.end();
}

bool is_file_of_any(std::string_view name) {
  return name == kConfigFile || is_file_of(Results::kRun, name) || is_file_of(Results::kAccuracy, name) ||
         is_file_of(Results::kStress, name);
}

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

/// The results of another configuration that a folder holds, in words; empty if there are none.
std::string other_results(const fs::path& folder, const Config* config) {
  std::error_code ignored;
  const bool has_config = fs::exists(folder / kConfigFile, ignored);
  if (!has_config && std::none_of(kFiles.begin(), kFiles.end(),
                                  [&](const auto& files) { return fs::exists(folder / files.front(), ignored); }))
    return "";
  if (config == nullptr) return has_config ? "the results of a configuration, and here there is none" : "";
  std::optional<Config> there = config_in(folder);
  if (!there) return "the results of a configuration that cannot be read";
  there->engine.threads = config->engine.threads;  // is the host's affair, and changes no result
  const std::vector<std::string> here = config_differences(*there, *config);
  if (here.empty()) return "";
  const std::vector<std::string> were = config_differences(*config, *there);
  return fmt::format("the results of another configuration, with {}{}, not {}",
                     were.empty() ? "other keys" : were.front(),
                     were.size() > 1 ? fmt::format(" and {} more differences", were.size() - 1) : "", here.front());
}

/// True for the working folder: a user's shell would stay in the one that is taken away.
bool is_current(const fs::path& folder) {
  std::error_code error;
  return fs::equivalent(folder, fs::current_path(error), error);
}

}  // namespace

OutputFolder::OutputFolder(const fs::path& folder, const Config* config, bool force, Results results)
    : folder_(folder), results_(results) {
  std::error_code error;
  target_ = fs::weakly_canonical(fs::absolute(folder), error);
  if (error) fail(folder, error.message());
  if (!target_.has_filename()) target_ = target_.parent_path();
  const fs::file_status status = fs::status(target_, error);
  if (fs::exists(status) && !fs::is_directory(status)) fail(folder / "", "it is not a folder");
  const std::string others = other_results(target_, config);
  of_another_ = !others.empty();
  if (of_another_ && !force)
    throw ConfigError("--out",
                      fmt::format("{} holds {}; expected a folder of its own (--out DIR), or --force to replace them",
                                  folder.string(), others));
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

/// True for files that are not there any more after commit(), unless they have been made anew.
bool OutputFolder::is_replaced(const std::string& name) const {
  return name == kConfigFile || is_file_of(results_, name) || (of_another_ && is_file_of_any(name));
}

bool OutputFolder::holds_only_replaced() const {
  for (const fs::directory_entry& entry : fs::directory_iterator(target_))
    if (!entry.is_regular_file() || entry.is_symlink() || !is_replaced(entry.path().filename().string())) return false;
  return true;
}

/// Moves the files one by one, the result last: where there is a result, all that belongs to it is there.
void OutputFolder::move_each() const {
  std::error_code error;
  const fs::path result = result_of(results_);
  fs::remove(target_ / result, error);
  std::vector<fs::path> old, names;
  for (const fs::directory_entry& entry : fs::directory_iterator(target_)) old.push_back(entry.path().filename());
  for (const fs::path& name : old)
    if (is_replaced(name.string()) && !fs::exists(staging_ / name, error)) fs::remove(target_ / name, error);
  for (const fs::directory_entry& entry : fs::directory_iterator(staging_)) names.push_back(entry.path().filename());
  std::stable_partition(names.begin(), names.end(), [&](const fs::path& name) { return name != result; });
  for (const fs::path& name : names) move_to(staging_ / name, target_ / name);
}

void OutputFolder::commit() {
  try {
    const bool beside = staging_.parent_path() == target_.parent_path();
    if (!fs::exists(target_) && beside) {
      move_to(staging_, target_);
      staging_.clear();
    } else if (beside && holds_only_replaced() && !is_current(target_) &&
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

std::exception_ptr OutputFolder::write(const std::function<void(const fs::path&)>& write) {
  try {
    write(staging_);
    commit();
  } catch (const FileError&) {
    return std::current_exception();
  }
  return nullptr;
}

}  // namespace carousel::app
