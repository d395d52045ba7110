#pragma once

#include <filesystem>
#include <string>

namespace carousel::app {

/// The folder of a sweep: made if it is missing, and held by one coordinator, or one a shard, at a time. The processes
/// that a coordinator starts hold it as well, so that no point runs twice at once even after the coordinator was
/// killed.
class FolderLock {
 public:
  /// `name`: of the lock's file. Throws FileError if the folder cannot be written or another sweep works there.
  FolderLock(const std::filesystem::path& folder, const std::string& name);
  ~FolderLock();
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;

 private:
  int descriptor_ = -1;
};

}  // namespace carousel::app
