#include "modules/scenes/source_files.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <system_error>

#include <assimp/DefaultIOSystem.h>
#include <assimp/IOStream.hpp>

namespace carousel::scenes {

namespace {

namespace fs = std::filesystem;

/// Texts that are larger are not searched for the place of a fault.
constexpr std::uintmax_t kLargestText = std::uintmax_t{256} << 20;

std::string with_slashes(std::string name) {
  std::ranges::replace(name, '\\', '/');
  return name;
}

std::string last_part(const std::string& name) {
  const std::string path = with_slashes(name);
  return path.substr(path.rfind('/') + 1);
}

bool is_file(const fs::path& file) {
  std::error_code error;
  return fs::is_regular_file(file, error);
}

}  // namespace

SourceFiles::SourceFiles(const fs::path& model)
    : folder_(fs::weakly_canonical(model).parent_path()), root_(folder_.parent_path().parent_path()) {
  read_.push_back(fs::weakly_canonical(model));
}

bool SourceFiles::allowed(const fs::path& file) const {
  std::error_code error;
  const fs::path real = fs::weakly_canonical(file, error);
  return !error && std::mismatch(root_.begin(), root_.end(), real.begin(), real.end()).first == root_.end();
}

fs::path SourceFiles::find(const std::string& name) const {
  const std::string path = with_slashes(name);
  for (const fs::path& candidate : {folder_ / path, folder_ / last_part(name)})
    if (!last_part(name).empty() && is_file(candidate) && allowed(candidate)) return candidate;
  return {};
}

std::string SourceFiles::beside(const std::string& name) const {
  return (folder_ / last_part(name)).string();
}

std::string SourceFiles::place_of(std::string_view name) const {
  if (name.empty()) return "";
  for (const fs::path& file : read_) {
    std::error_code error;
    if (fs::file_size(file, error) > kLargestText || error) continue;
    std::ifstream in(file, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    const std::size_t at = text.find(name);
    if (at == text.npos) continue;
    const auto begin = text.begin(), end = begin + static_cast<std::ptrdiff_t>(at);
    if (std::find(begin, end, '\0') != end) return file.filename().string();
    return file.filename().string() + ":" + std::to_string(1 + std::count(begin, end, '\n'));
  }
  return "";
}

bool SourceFiles::exists(const std::string& name) const {
  return is_file(name) && allowed(name);
}

Assimp::IOStream* SourceFiles::open(const std::string& name, const char* mode) {
  if (mode == nullptr || mode[0] != 'r') return nullptr;
  if (!exists(name)) {
    if (std::ranges::find(not_there_, name) == not_there_.end()) not_there_.push_back(name);
    return nullptr;
  }
  const fs::path real = fs::weakly_canonical(name);
  if (std::ranges::find(read_, real) == read_.end()) read_.push_back(real);
  return Assimp::DefaultIOSystem().Open(real.c_str(), mode);
}

std::vector<SourceFiles::Missing> SourceFiles::missing() const {
  std::vector<Missing> out;
  for (const std::string& name : not_there_) {
    const std::string last = last_part(name);
    const std::string place = place_of(last);
    const bool told = std::ranges::any_of(out, [&](const Missing& other) { return other.name == last; });
    if (!place.empty() && !told) out.push_back({last, place});
  }
  return out;
}

std::vector<std::string> SourceFiles::all() const {
  std::vector<std::string> out;
  for (const fs::path& file : read_) out.push_back(file.string());
  out.insert(out.end(), not_there_.begin(), not_there_.end());
  return out;
}

void SourceFileSystem::Close(Assimp::IOStream* file) {
  delete file;
}

}  // namespace carousel::scenes
