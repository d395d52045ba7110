#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/system/error.h"

namespace carousel {

/// A plugin that is open.
struct Plugin {
  /// A value that it has brought.
  struct Part {
    std::string what, name;  ///< "queue", "my_queue"
  };

  std::filesystem::path file;  ///< absolute, without links
  std::string name, version;   ///< its own
  std::string digest;          ///< of the file's bytes, when it was opened
  std::vector<Part> parts;
};

/// A plugin is not there, is none, or is refused; the message names the file and the reason. Exit status 2.
class PluginError : public FileError {
 public:
  using FileError::FileError;
};

/// Opens the plugin in a file, once in a process, in which it stays. Its values count where configurations name the
/// file (named_values()). Any thread. Throws PluginError.
///
/// Runs no code of a file that is of another build. From then on the plugin's code is trusted: it runs within the
/// program, and may do what the program may.
const Plugin& open_plugin(const std::filesystem::path& file);

/// The file that a configuration in `folder` means: beside it, or else in the working folder.
std::filesystem::path plugin_file(const std::filesystem::path& folder, const std::string& name);

}  // namespace carousel
