#pragma once

#include <csignal>

#include <sys/resource.h>

namespace carousel {

/// While it lives, no file of this process grows beyond so many bytes: what a full disk or a quota looks like,
/// without a disk.
class FullDisk {
 public:
  explicit FullDisk(rlim_t bytes) : dispatch_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    rlimit small = before_;
    small.rlim_cur = bytes;
    setrlimit(RLIMIT_FSIZE, &small);
  }
  ~FullDisk() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, dispatch_);
  }
  FullDisk(const FullDisk&) = delete;
  FullDisk& operator=(const FullDisk&) = delete;

 private:
  rlimit before_{};
  void (*dispatch_)(int);
};

}  // namespace carousel
