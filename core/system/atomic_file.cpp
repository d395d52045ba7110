#include "core/system/atomic_file.h"

#include <cerrno>
#include <cstring>
#include <utility>

#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <sys/stat.h>

#include "core/system/error.h"
#include "core/system/file_calls.h"
#include "core/system/stop_request.h"
#include "core/system/unfinished.h"

namespace carousel {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kBufferBytes = 1 << 16;

/// Opens and locks a new file beside `target`; negative if it cannot be made. Between both it may have been taken for
/// an abandoned one and removed, and is then made again.
int open_beside(const fs::path& target, fs::path& name) {
  for (;;) {
    name = unfinished_name(target, kUnfinishedFile);
    const int out = files::open_file(name, O_WRONLY | O_CREAT | O_EXCL);
    if (out < 0 && errno == EEXIST) continue;
    if (out < 0) return out;
    files::lock_file(out, true);
    struct stat status {};
    if (fstat(out, &status) != 0 || status.st_nlink > 0) return out;
    files::close_file(out);
  }
}

/// Opens a pipe or a device. A reader of a pipe is waited for.
int open_directly(const fs::path& target) {
  for (;;) {
    const int out = files::open_file(target, O_WRONLY | O_NONBLOCK);
    std::error_code ignored;
    if (out >= 0 || errno != ENXIO || !fs::is_fifo(target, ignored)) return out;
    constexpr int kPauseMs = 20;
    poll(nullptr, 0, kPauseMs);
    throw_if_stopped("a reader of " + target.string());
  }
}

/// While it lives, a pipe that nobody reads any more is an error of write and no signal for this thread.
class NoPipeSignal {
 public:
  NoPipeSignal() {
    sigemptyset(&pipe_);
    sigaddset(&pipe_, SIGPIPE);
    pthread_sigmask(SIG_BLOCK, &pipe_, &before_);
  }
  ~NoPipeSignal() {
    const timespec now{};
    while (sigismember(&before_, SIGPIPE) == 0 && sigtimedwait(&pipe_, nullptr, &now) > 0) continue;
    pthread_sigmask(SIG_SETMASK, &before_, nullptr);
  }
  NoPipeSignal(const NoPipeSignal&) = delete;
  NoPipeSignal& operator=(const NoPipeSignal&) = delete;

 private:
  sigset_t pipe_{}, before_{};
};

}  // namespace

AtomicFile::AtomicFile(const fs::path& target) : target_(target) {
  std::error_code error;
  // A link keeps pointing to what it points to: that is replaced, not the link.
  if (fs::is_symlink(target_, error)) {
    if (const fs::path real = fs::weakly_canonical(target_, error); !error) target_ = real;
  }
  const fs::file_status status = fs::status(target_, error);
  if (fs::is_directory(status)) fail(EISDIR);
  if (fs::exists(status) && !fs::is_regular_file(status)) {
    descriptor_ = open_directly(target_);
    if (descriptor_ < 0) fail(errno);
    return;
  }
  const auto made = [this](const fs::path& folder) { made_.push_back(folder); };
  if (files::make_folders(target_.parent_path(), made) == 0) descriptor_ = open_beside(target_, unfinished_);
  if (descriptor_ >= 0) return;
  const int why = errno;
  unfinished_.clear();
  discard();
  fail(why);
}

AtomicFile::~AtomicFile() {
  discard();
}

void AtomicFile::discard() {
  if (descriptor_ >= 0) files::close_file(std::exchange(descriptor_, -1));
  if (!unfinished_.empty()) files::remove_file(std::exchange(unfinished_, {}));
  for (; !made_.empty(); made_.pop_back()) files::remove_folder(made_.back());  // one that is in use stays
}

void AtomicFile::fail(int error) const {
  throw FileError("cannot write " + target_.string() + ": " + std::strerror(error));
}

void AtomicFile::write(std::string_view bytes) {
  buffer_ += bytes;
  if (buffer_.size() >= kBufferBytes) flush();
}

void AtomicFile::flush() {
  const NoPipeSignal no_signal;
  for (std::string_view rest = buffer_; !rest.empty();) {
    if (unfinished_.empty()) wait_for(descriptor_, POLLOUT, "the reader of " + target_.string());
    const ssize_t count = files::write_bytes(descriptor_, rest);
    if (count < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (count < 0) fail(errno);
    rest.remove_prefix(static_cast<std::size_t>(count));
  }
  buffer_.clear();
}

void AtomicFile::finish() {
  flush();
  // A disk may accept bytes and refuse them later; only then may the old file go. Pipes have nothing to sync.
  if (!unfinished_.empty() && !finished_ && files::sync_file(descriptor_) != 0) fail(errno);
  finished_ = true;
}

void AtomicFile::commit() {
  finish();
  if (unfinished_.empty()) {
    if (files::close_file(std::exchange(descriptor_, -1)) != 0 && errno != EINTR) fail(errno);
    return;
  }
  // Before it is closed, which would unlock it. After fsync close has no more errors to tell.
  if (files::rename_file(unfinished_, target_) != 0) fail(errno);
  unfinished_.clear();
  files::close_file(std::exchange(descriptor_, -1));
  if (files::sync_folder(target_.parent_path()) != 0) fail(errno);
  for (; !made_.empty(); made_.pop_back())
    if (files::sync_folder(made_.back().parent_path()) != 0) fail(errno);
}

void write_file(const fs::path& target, std::string_view bytes) {
  remove_abandoned_of(target);
  AtomicFile file(target);
  file.write(bytes);
  file.commit();
}

}  // namespace carousel
