#include "app/sweep/folder_lock.h"

#include <cerrno>
#include <chrono>
#include <cstring>
#include <thread>

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include "core/system/error.h"

namespace carousel::app {

namespace {

// Processes of a killed coordinator end at once, but not before it.
constexpr int kTries = 50;
constexpr std::chrono::milliseconds kPause{100};

}  // namespace

FolderLock::FolderLock(const std::filesystem::path& folder, const std::string& name) {
  const auto fail = [&](int error) {
    throw FileError("cannot write " + folder.string() + ": " + std::strerror(error));
  };
  std::error_code error;
  std::filesystem::create_directories(folder / "points", error);
  if (error) fail(error.value());
  if (access((folder / "points").c_str(), W_OK | X_OK) != 0) fail(errno);
  descriptor_ = open((folder / name).c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor_ < 0) fail(errno);
  for (int i = 0; flock(descriptor_, LOCK_EX | LOCK_NB) != 0; ++i) {
    if (errno != EWOULDBLOCK) return;  // a file system without locks
    if (i == kTries) throw FileError("another sweep works in " + folder.string() + "; expected one at a time");
    std::this_thread::sleep_for(kPause);
  }
}

FolderLock::~FolderLock() {
  if (descriptor_ >= 0) close(descriptor_);
}

}  // namespace carousel::app
