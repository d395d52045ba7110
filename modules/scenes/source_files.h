#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include <assimp/IOSystem.hpp>

namespace carousel::scenes {

/// The files that a model consists of: the one that was named, and those that it names, within its folder and the two
/// above it. Remembers which were read and which are not there.
class SourceFiles {
 public:
  explicit SourceFiles(const std::filesystem::path& model);

  /// The file that `name` stands for in the model; empty if there is none. Names of other systems are tried too:
  /// `C:\\models\\wood.png` is found beside the model.
  std::filesystem::path find(const std::string& name) const;

  /// The file of that name in the model's folder, where it would be.
  std::string beside(const std::string& name) const;

  /// Where a text of the model first mentions `name`: "arm.mtl:5", or "arm.fbx" where the file is no text. Empty if
  /// none does.
  std::string place_of(std::string_view name) const;

  /// Opens a file for reading; null if it is not there, or not allowed.
  Assimp::IOStream* open(const std::string& name, const char* mode);
  bool exists(const std::string& name) const;

  /// Files that were asked for, are mentioned in the model, and are not there, with their places.
  struct Missing {
    std::string name, place;
  };
  std::vector<Missing> missing() const;

  /// The files that were read, the model first, and those that were asked for and are not there.
  std::vector<std::string> all() const;

 private:
  bool allowed(const std::filesystem::path& file) const;

  std::filesystem::path folder_, root_;
  std::vector<std::filesystem::path> read_;
  std::vector<std::string> not_there_;
};

/// What Assimp's importers open files through.
class SourceFileSystem : public Assimp::IOSystem {
 public:
  explicit SourceFileSystem(SourceFiles& files) : files_(files) {}
  bool Exists(const char* file) const override { return files_.exists(file); }
  char getOsSeparator() const override { return '/'; }
  Assimp::IOStream* Open(const char* file, const char* mode) override { return files_.open(file, mode); }
  void Close(Assimp::IOStream* file) override;

 private:
  SourceFiles& files_;
};

}  // namespace carousel::scenes
