#include "core/system/atomic_file.h"

#include <atomic>
#include <cerrno>
#include <cstring>
#include <utility>

#include <fcntl.h>
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
    temporary_ = name_beside(target_);
    descriptor_ = open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
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
  if (close(std::exchange(descriptor_, -1)) != 0) fail(errno);
  if (temporary_.empty()) return;
  if (std::rename(temporary_.c_str(), target_.c_str()) != 0) fail(errno);
  temporary_.clear();
}

void write_file(const std::filesystem::path& target, std::string_view bytes) {
  AtomicFile file(target);
  file.write(bytes);
  file.commit();
}

}  // namespace carousel
