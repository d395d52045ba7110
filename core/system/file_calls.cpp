#include "core/system/file_calls.h"

#include <atomic>
#include <cerrno>
#include <cstdio>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace carousel::files {

namespace {

std::atomic<const Fault*> g_fault{nullptr};

/// Sets errno if the call is to fail.
bool fails(Call call, const Path& path) {
  const Fault* fault = g_fault.load(std::memory_order_acquire);  // pairs with the store of FaultScope
  const int error = fault == nullptr ? 0 : (*fault)(call, path);
  if (error != 0) errno = error;
  return error != 0;
}

}  // namespace

FaultScope::FaultScope(Fault fault) : fault_(std::move(fault)) {
  g_fault.store(&fault_, std::memory_order_release);
}

FaultScope::~FaultScope() {
  g_fault.store(nullptr, std::memory_order_release);
}

int open_file(const Path& file, int flags) {
  return fails(Call::kOpen, file) ? -1 : ::open(file.c_str(), flags | O_CLOEXEC, 0666);
}

ssize_t write_bytes(int descriptor, std::string_view bytes) {
  return fails(Call::kWrite, {}) ? -1 : ::write(descriptor, bytes.data(), bytes.size());
}

int sync_file(int descriptor) {
  return fails(Call::kSync, {}) ? -1 : ::fsync(descriptor);
}

/// The descriptor is closed whatever is returned, as by Linux.
int close_file(int descriptor) {
  const int result = ::close(descriptor);
  return fails(Call::kClose, {}) ? -1 : result;
}

int rename_file(const Path& from, const Path& to) {
  return fails(Call::kRename, to) ? -1 : ::rename(from.c_str(), to.c_str());
}

int exchange_names(const Path& one, const Path& other) {
  return fails(Call::kExchange, other) ? -1
                                       : renameat2(AT_FDCWD, one.c_str(), AT_FDCWD, other.c_str(), RENAME_EXCHANGE);
}

int make_folder(const Path& folder) {
  return fails(Call::kMakeFolder, folder) ? -1 : ::mkdir(folder.c_str(), 0777);
}

int remove_file(const Path& file) {
  return fails(Call::kRemove, file) ? -1 : ::unlink(file.c_str());
}

int remove_folder(const Path& folder) {
  return fails(Call::kRemove, folder) ? -1 : ::rmdir(folder.c_str());
}

Lock lock_file(int descriptor, bool wait) {
  for (;;) {
    if (!fails(Call::kLock, {}) && ::flock(descriptor, wait ? LOCK_EX : LOCK_EX | LOCK_NB) == 0) return Lock::kHeld;
    if (errno == EWOULDBLOCK) return Lock::kBusy;
    if (errno != EINTR) return Lock::kNone;
  }
}

int sync_folder(const Path& folder) {
  const int descriptor = open_file(folder.empty() ? "." : folder, O_RDONLY | O_DIRECTORY);
  if (descriptor < 0) return errno == EACCES ? 0 : -1;
  const int result = sync_file(descriptor);
  const int why = errno;
  ::close(descriptor);
  errno = why;
  return result != 0 && (why == EINVAL || why == ENOTSUP || why == ENOSYS || why == EROFS) ? 0 : result;
}

int make_folders(const Path& folder, const std::function<void(const Path&)>& made) {
  std::vector<Path> missing;
  std::error_code error;
  for (Path at = folder; !at.empty() && !std::filesystem::exists(at, error); at = at.parent_path()) {
    if (at.has_filename()) missing.push_back(at);
    if (at == at.parent_path()) break;
  }
  for (auto at = missing.rbegin(); at != missing.rend(); ++at) {
    if (make_folder(*at) == 0)
      made(*at);
    else if (errno != EEXIST)  // another process has been faster
      return -1;
  }
  if (!folder.empty() && !std::filesystem::is_directory(folder, error)) {
    errno = ENOTDIR;
    return -1;
  }
  return 0;
}

void remove_tree(const Path& folder) {
  std::error_code error;
  std::vector<std::filesystem::directory_entry> entries;
  for (std::filesystem::directory_iterator at(folder, error), end; !error && at != end; at.increment(error))
    entries.push_back(*at);
  for (const std::filesystem::directory_entry& entry : entries) {
    if (!entry.is_symlink(error) && entry.is_directory(error))
      remove_tree(entry.path());
    else
      remove_file(entry.path());
  }
  remove_folder(folder);
}

}  // namespace carousel::files
