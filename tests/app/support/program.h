#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <sys/types.h>

namespace carousel {

struct Outcome {
  int status = -1;  ///< exit status, or 128 + signal
  std::string out, err;
};

/// Adds `--set` and each of the sets.
inline void add_sets(std::vector<std::string>& arguments, const std::vector<std::string>& sets) {
  for (const std::string& set : sets) arguments.insert(arguments.end(), {"--set", set});
}

/// The program running in a folder of its own; the tests' way to see what a user sees.
class Program {
 public:
  Program();
  ~Program();  ///< removes the folder

  const std::filesystem::path& folder() const { return folder_; }
  /// Makes a file in the folder.
  void write(const std::string& name, const std::string& text) const;
  std::string read(const std::string& name) const;

  Outcome run(const std::vector<std::string>& arguments) const;

  /// Starts without waiting. `own_group`: in a group of processes of its own, with its number, to be killed as a whole.
  pid_t start(const std::vector<std::string>& arguments, bool own_group = false) const;
  Outcome wait(pid_t pid) const;

 private:
  std::filesystem::path folder_;
};

}  // namespace carousel
