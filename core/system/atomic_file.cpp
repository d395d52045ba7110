#include "core/system/atomic_file.h"

#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <thread>
#include <utility>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "core/system/error.h"

namespace carousel {

namespace {

constexpr std::size_t kBufferBytes = 1 << 16;

/// Of this process and this call, so that no two writers share one.
std::filesystem::path name_beside(const std::filesystem::path& target) {
  static std::atomic<unsigned> number{0};
  std::filesystem::path out = target;
  // Relaxed: only the numbers have to differ.
  out.replace_filename("." + target.filename().string() + "." + std::to_string(getpid()) + "." +
                       std::to_string(number.fetch_add(1, std::memory_order_relaxed)) + ".partial");
  return out;
}

/// Opens and locks a new file beside `target`; negative if it cannot be made. Between both it may have been taken for
/// an abandoned one and removed, and is then made again.
int open_beside(const std::filesystem::path& target, std::filesystem::path& name) {
  for (;;) {
    name = name_beside(target);
    const int out = open(name.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (out < 0) return out;
    while (flock(out, LOCK_EX) != 0 && errno == EINTR) continue;  // other errors: a file system without locks
    struct stat status {};
    if (fstat(out, &status) != 0 || status.st_nlink > 0) return out;
    close(out);
  }
}

/// Removes an unfinished file unless it is locked. True if it is gone.
bool remove_unlocked(const std::filesystem::path& file) {
  const int descriptor = open(file.c_str(), O_WRONLY | O_CLOEXEC);  // NFS locks only what may be written
  if (descriptor < 0) return errno == ENOENT;
  const bool ours = flock(descriptor, LOCK_EX | LOCK_NB) == 0;
  if (ours) unlink(file.c_str());
  close(descriptor);
  return ours;
}

}  // namespace

AtomicFile::AtomicFile(const std::filesystem::path& target) : target_(target) {
  namespace fs = std::filesystem;
  std::error_code error;
  // A link keeps pointing to what it points to: that is replaced, not the link.
  if (fs::is_symlink(target_, error)) {
    if (const fs::path real = fs::weakly_canonical(target_, error); !error) target_ = real;
  }
  const fs::file_status status = fs::status(target_, error);
  if (fs::is_directory(status)) fail(EISDIR);
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    descriptor_ = open(target_.c_str(), O_WRONLY | O_CLOEXEC);
  } else {
    if (target_.has_parent_path()) {
      fs::create_directories(target_.parent_path(), error);
      if (error) fail(error.value());
    }
    descriptor_ = open_beside(target_, temporary_);
  }
  if (descriptor_ < 0) fail(errno);
}

AtomicFile::~AtomicFile() {
  if (descriptor_ >= 0) close(descriptor_);
  if (!temporary_.empty()) unlink(temporary_.c_str());
}

void AtomicFile::fail(int error) const {
  throw FileError("cannot write " + target_.string() + ": " + std::strerror(error));
}

void AtomicFile::write(std::string_view bytes) {
  buffer_ += bytes;
  if (buffer_.size() >= kBufferBytes) flush();
}

void AtomicFile::flush() {
  for (std::size_t done = 0; done < buffer_.size();) {
    const ssize_t count = ::write(descriptor_, buffer_.data() + done, buffer_.size() - done);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) fail(errno);
    done += static_cast<std::size_t>(count);
  }
  buffer_.clear();
}

void AtomicFile::commit() {
  flush();
  // A disk may accept bytes and refuse them later; only then may the old file go. Pipes have nothing to sync.
  if (!temporary_.empty() && fsync(descriptor_) != 0) fail(errno);
  if (!temporary_.empty()) {
    // Before it is closed, which would unlock it. After fsync close has no more errors to tell.
    if (std::rename(temporary_.c_str(), target_.c_str()) != 0) fail(errno);
    temporary_.clear();
  }
  if (close(std::exchange(descriptor_, -1)) != 0 && errno != EINTR) fail(errno);
}

void write_file(const std::filesystem::path& target, std::string_view bytes) {
  AtomicFile file(target);
  file.write(bytes);
  file.commit();
}

void remove_abandoned(const std::filesystem::path& folder) {
  constexpr int kTries = 50;
  constexpr std::chrono::milliseconds kPause{20};
  for (int i = 0; i < kTries; ++i) {
    bool all_gone = true;
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
      const std::string name = entry.path().filename();
      if (name[0] == '.' && name.ends_with(".partial")) all_gone = remove_unlocked(entry.path()) && all_gone;
    }
    if (all_gone) return;
    std::this_thread::sleep_for(kPause);
  }
}

}  // namespace carousel
