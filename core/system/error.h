#pragma once

#include <stdexcept>
#include <string>
#include <vector>

namespace carousel {

/// A position in a user's file. Lines and columns count from 1; 0 means unknown. For values that
/// come from the command line, `file` is the option's text, e.g. "--set image.width=0".
struct SourcePosition {
  std::string file;
  int line = 0;
  int column = 0;

  /// "file:line:column", without the parts that are unknown.
  std::string text() const;
};

/// One thing wrong with a configuration.
struct ConfigIssue {
  SourcePosition position;
  std::string key_path;  ///< e.g. "topology.link.depth"; empty when the whole file is meant
  std::string message;   ///< expected value, found value, and the nearest valid name

  std::string text() const;
};

/// The user's configuration is wrong; holds every problem found in it. Exit status 2.
class ConfigError : public std::runtime_error {
 public:
  explicit ConfigError(std::vector<ConfigIssue> issues);
  /// The error of one key or option whose place in the file is not known.
  ConfigError(std::string key_path, std::string message);
  const std::vector<ConfigIssue>& issues() const { return issues_; }

 private:
  std::vector<ConfigIssue> issues_;
};

/// The user's scene (or a file it names) is wrong. Exit status 2.
class SceneError : public std::runtime_error {
 public:
  /// Control characters of the texts, which may come from the file, are replaced (plain_text.h). `json_path` as in
  /// "/meshes/0/primitives/1/indices"; empty when the whole file is meant.
  SceneError(std::string file, std::string json_path, std::string message);
  const std::string& file() const { return file_; }
  const std::string& json_path() const { return json_path_; }
  const std::string& message() const { return message_; }

 private:
  std::string file_, json_path_, message_;
};

/// A file could not be written or read (disk full, permissions). Exit status 2.
class FileError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// An invariant of the program broke or the simulation got stuck; the message holds the evidence. Exit status 1.
class SimulationError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace carousel
