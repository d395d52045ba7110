#include "app/host/output_folder.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <optional>
#include <system_error>
#include <utility>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/config/differences.h"
#include "core/config/load/load.h"
#include "core/system/error.h"
#include "core/system/file_calls.h"
#include "core/system/unfinished.h"
#include "report/text/singular.h"

namespace carousel::app {

namespace fs = std::filesystem;

namespace {

constexpr const char* kConfigFile = "config.resolved.yaml";  // all commands write it

/// The files of a command, by Results; the first is its result, which appears last. A run also has pictures.
constexpr std::array<std::array<std::string_view, 8>, 4> kFiles{{
    {"report.json", "report.html", "hits.csv", "heat.csv", "heat_cycles.png", "heat_tests.png", "heat_hops.png",
     "heat_waiting.png"},
    {"accuracy.json", "accuracy.html"},
    {"stress.json", "stress.html"},
    {"versus.json", "versus.html"},
}};

std::string_view result_of(Results results) {
  return kFiles[static_cast<std::size_t>(results)].front();
}

/// Also one of a series, with its number of four digits or more.
bool is_picture(std::string_view name) {
  constexpr std::string_view kStem = "image.";
  if (!name.starts_with(kStem)) return false;
  name.remove_prefix(kStem.size());
  const std::size_t digits = std::min(name.find_first_not_of("0123456789"), name.size());
  if (digits >= 4 && name.substr(digits).starts_with('.')) name.remove_prefix(digits + 1);
  return enum_value<PictureFile>(name).has_value();
}

bool is_file_of(Results results, std::string_view name) {
  if (results == Results::kRun && is_picture(name)) return true;
  const auto& files = kFiles[static_cast<std::size_t>(results)];
  return !name.empty() && std::find(files.begin(), files.end(), name) != files.end();
}

bool is_file_of_any(std::string_view name) {
  return name == kConfigFile || is_file_of(Results::kRun, name) || is_file_of(Results::kAccuracy, name) ||
         is_file_of(Results::kStress, name) || is_file_of(Results::kVersus, name);
}

[[noreturn]] void fail(const fs::path& path, const std::string& why) {
  throw FileError("cannot write " + path.string() + ": " + why);
}

/// Fails with errno unless a call has returned 0.
void require(int result, const fs::path& path) {
  if (result != 0) fail(path, std::strerror(errno));
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
  return fmt::format(
      "the results of another configuration, with {}{}, not {}", were.empty() ? "other keys" : were.front(),
      were.size() > 1 ? report::singular(fmt::format(" and {} more differences", were.size() - 1)) : "", here.front());
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
  const auto made = [this](const fs::path& above) { made_.push_back(above); };
  bool ready = files::make_folders(target_.parent_path(), made) == 0;
  if (ready && fs::is_directory(status)) {
    if (access(target_.c_str(), W_OK | X_OK) != 0) fail(folder, std::strerror(errno));
    remove_abandoned_of(target_ / target_.filename());
  }
  if (ready) remove_abandoned_of(target_);
  ready = ready && (make_staging(target_) || (fs::is_directory(status) && make_staging(target_ / target_.filename())));
  const int why = errno;
  if (!ready) remove_made();
  if (!ready) fail(folder, std::strerror(why));
}

OutputFolder::~OutputFolder() {
  if (!staging_.empty()) files::remove_tree(staging_);
  if (lock_ >= 0) files::close_file(lock_);
  remove_made();
}

/// Only folders that are empty are removed: a run that ended without a result leaves nothing.
void OutputFolder::remove_made() {
  for (; !made_.empty(); made_.pop_back()) files::remove_folder(made_.back());
}

/// Makes the hidden folder beside `target`, and locks it. A lock ends with its process, however that ends. Before it is
/// locked, the folder may have been taken for an abandoned one and removed, and is then made again.
bool OutputFolder::make_staging(const fs::path& target) {
  for (;;) {
    staging_ = unfinished_name(target, "");
    if (files::make_folder(staging_) != 0) {
      if (errno == EEXIST) continue;
      staging_.clear();
      return false;
    }
    lock_ = files::open_file(staging_, O_RDONLY | O_DIRECTORY);
    if (lock_ < 0 && errno == ENOENT) continue;
    if (lock_ < 0) return fail_staging();
    files::lock_file(lock_, true);
    struct stat opened {
    }, named{};
    if (fstat(lock_, &opened) == 0 && stat(staging_.c_str(), &named) == 0 && opened.st_ino == named.st_ino) return true;
    files::close_file(std::exchange(lock_, -1));
  }
}

bool OutputFolder::fail_staging() {
  const int why = errno;
  files::remove_folder(std::exchange(staging_, {}));
  errno = why;
  return false;
}

bool OutputFolder::holds_result(const fs::path& file) const {
  return file.parent_path() == target_ && is_file_of_any(file.filename().string());
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
  const auto remove = [&](const fs::path& name) {
    if (files::remove_file(target_ / name) != 0 && errno != ENOENT) fail(folder_ / name, std::strerror(errno));
  };
  remove(result);
  std::vector<fs::path> old, names;
  for (const fs::directory_entry& entry : fs::directory_iterator(target_)) old.push_back(entry.path().filename());
  for (const fs::path& name : old)
    if (is_replaced(name.string()) && !fs::exists(staging_ / name, error)) remove(name);
  for (const fs::directory_entry& entry : fs::directory_iterator(staging_)) names.push_back(entry.path().filename());
  std::stable_partition(names.begin(), names.end(), [&](const fs::path& name) { return name != result; });
  for (const fs::path& name : names) require(files::rename_file(staging_ / name, target_ / name), folder_ / name);
  require(files::sync_folder(target_), folder_);
}

void OutputFolder::commit() {
  try {
    const bool beside = staging_.parent_path() == target_.parent_path();
    if (!fs::exists(target_) && beside) {
      require(files::rename_file(staging_, target_), folder_);
      staging_.clear();
    } else if (beside && holds_only_replaced() && !is_current(target_) &&
               files::exchange_names(staging_, target_) == 0) {
      // staging_ is now the old folder, which the destructor removes.
    } else {
      require(files::make_folders(target_, [](const fs::path&) {}), folder_);
      move_each();
    }
  } catch (const fs::filesystem_error& error) {
    fail(folder_, error.code().message());
  }
  require(files::sync_folder(target_.parent_path()), folder_);
  for (; !made_.empty(); made_.pop_back()) require(files::sync_folder(made_.back().parent_path()), folder_);
}

std::exception_ptr OutputFolder::write(const std::function<void(const fs::path&)>& write) {
  try {
    write(staging_);
    commit();
  } catch (const FileError& error) {
    // The user knows the folder by its own name.
    std::string text = error.what();
    if (const std::size_t at = text.find(staging_.string()); !staging_.empty() && at != text.npos)
      text.replace(at, staging_.string().size(), folder_.string());
    return std::make_exception_ptr(FileError(text));
  }
  return nullptr;
}

}  // namespace carousel::app
