#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string_view>

#include <sys/types.h>

/// The one door to the calls of the system that make, change and remove files. Each function makes one of them and
/// returns what that returned, with errno. Tests can make any of the calls fail.
namespace carousel::files {

using Path = std::filesystem::path;

/// Closes the descriptor on exec. New files get 0666 less the umask.
int open_file(const Path& file, int flags);
ssize_t write_bytes(int descriptor, std::string_view bytes);
int sync_file(int descriptor);
int close_file(int descriptor);
int rename_file(const Path& from, const Path& to);
/// Gives each of the two the name of the other (renameat2).
int exchange_names(const Path& one, const Path& other);
int make_folder(const Path& folder);
int remove_file(const Path& file);
int remove_folder(const Path& folder);

enum class Lock : std::uint8_t { kHeld, kBusy, kNone };  ///< kNone: the file system has no locks
/// Locks an open file or folder (flock); `wait`: until nobody else holds it.
Lock lock_file(int descriptor, bool wait);

/// Makes the names in a folder last: a rename may otherwise be forgotten when the host loses power. 0 too where the
/// file system knows nothing of the kind, or the folder may not be read.
int sync_folder(const Path& folder);
/// Makes a folder and those above it that are missing, and tells each that it has made, outermost first.
int make_folders(const Path& folder, const std::function<void(const Path&)>& made);
/// Removes a folder with everything in it, as far as that is possible.
void remove_tree(const Path& folder);

enum class Call : std::uint8_t { kOpen, kWrite, kSync, kClose, kRename, kExchange, kMakeFolder, kRemove, kLock };
/// Is asked before each call; returns 0 or the error that the call fails with. The path is empty where the call has
/// a descriptor only.
using Fault = std::function<int(Call call, const Path& path)>;

/// While it lives, `fault` judges each call of this process. One at a time; for tests.
class FaultScope {
 public:
  explicit FaultScope(Fault fault);
  ~FaultScope();
  FaultScope(const FaultScope&) = delete;
  FaultScope& operator=(const FaultScope&) = delete;

 private:
  Fault fault_;
};

}  // namespace carousel::files
