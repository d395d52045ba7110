#include "core/system/unfinished.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <optional>
#include <thread>
#include <vector>

#include <fcntl.h>
#include <unistd.h>

#include "core/system/file_calls.h"

namespace carousel {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view kMark = ".carousel-";
constexpr std::chrono::hours kForgotten{30 * 24};

/// The name of this host, of characters that may stand in names.
std::string host_name() {
  std::array<char, 65> text{};
  if (gethostname(text.data(), text.size() - 1) != 0 || text[0] == '\0') return "host";
  std::string out = text.data();
  std::replace_if(
      out.begin(), out.end(), [](char c) { return c == '/' || c == '.' || c <= ' '; }, '_');
  return out;
}

/// The beginning of the names for a target. A long name is cut: names have 255 bytes at most.
std::string prefix_of(const fs::path& target) {
  constexpr std::size_t kLongest = 128;
  return "." + target.filename().string().substr(0, kLongest) + std::string(kMark);
}

struct Maker {
  std::string host;
  pid_t process = 0;
};

/// The maker that a name tells; absent if it is no such name.
std::optional<Maker> maker_of(std::string name) {
  if (name.ends_with(kUnfinishedFile)) name.resize(name.size() - kUnfinishedFile.size());
  const std::size_t mark = name.rfind(kMark);
  if (name.empty() || name[0] != '.' || mark == std::string::npos) return std::nullopt;
  const std::string_view text = std::string_view(name).substr(mark + kMark.size());
  const std::size_t first = text.find('.'), second = text.find('.', first + 1);
  if (first == text.npos || second == text.npos) return std::nullopt;
  Maker out{std::string(text.substr(0, first)), 0};
  const auto [end, error] = std::from_chars(text.data() + first + 1, text.data() + second, out.process);
  if (error != std::errc{} || end != text.data() + second || out.process <= 0) return std::nullopt;
  return out;
}

files::Lock lock_of(const fs::path& unfinished) {
  std::error_code error;
  // NFS locks only what may be written.
  const int flags = fs::is_directory(unfinished, error) ? O_RDONLY | O_DIRECTORY : O_WRONLY | O_NOFOLLOW;
  const int descriptor = files::open_file(unfinished, flags);
  if (descriptor < 0) return files::Lock::kNone;
  const files::Lock out = files::lock_file(descriptor, false);
  files::close_file(descriptor);
  return out;
}

void remove_any(const fs::path& unfinished) {
  std::error_code error;
  if (fs::is_directory(unfinished, error))
    files::remove_tree(unfinished);
  else
    files::remove_file(unfinished);
}

/// The entries of a folder: it may change while they are looked at.
std::vector<fs::path> entries_of(const fs::path& folder) {
  std::vector<fs::path> out;
  std::error_code error;
  for (fs::directory_iterator at(folder.empty() ? "." : folder, error), end; !error && at != end; at.increment(error))
    out.push_back(at->path());
  return out;
}

}  // namespace

fs::path unfinished_name(const fs::path& target, std::string_view end) {
  static std::atomic<unsigned> number{0};
  fs::path out = target;
  // Relaxed: only the numbers have to differ.
  out.replace_filename(prefix_of(target) + host_name() + "." + std::to_string(getpid()) + "." +
                       std::to_string(number.fetch_add(1, std::memory_order_relaxed)) + std::string(end));
  return out;
}

bool is_abandoned(const fs::path& unfinished) {
  const std::optional<Maker> maker = maker_of(unfinished.filename().string());
  if (!maker) return false;
  const files::Lock lock = lock_of(unfinished);
  if (lock == files::Lock::kBusy) return false;
  if (maker->host == host_name()) return lock == files::Lock::kHeld || (kill(maker->process, 0) != 0 && errno == ESRCH);
  std::error_code error;
  const auto changed = fs::last_write_time(unfinished, error);
  return !error && fs::file_time_type::clock::now() - changed > kForgotten;
}

void remove_abandoned_of(const fs::path& target) {
  const std::string prefix = prefix_of(target);
  for (const fs::path& entry : entries_of(target.parent_path()))
    if (entry.filename().string().starts_with(prefix) && is_abandoned(entry)) remove_any(entry);
}

void remove_abandoned(const fs::path& folder) {
  constexpr int kTries = 50;
  constexpr std::chrono::milliseconds kPause{20};
  for (int i = 0; i < kTries; ++i) {
    bool all_gone = true;
    for (const fs::path& entry : entries_of(folder)) {
      const std::string name = entry.filename().string();
      const std::optional<Maker> maker = maker_of(name);
      if (!name.ends_with(kUnfinishedFile) || !maker) continue;
      if (is_abandoned(entry))
        remove_any(entry);
      else
        all_gone &= maker->host != host_name();
    }
    if (all_gone) return;
    std::this_thread::sleep_for(kPause);
  }
}

}  // namespace carousel
