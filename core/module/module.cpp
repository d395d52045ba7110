#include "core/module/module.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <mutex>
#include <set>

#include <dlfcn.h>
#include <fmt/format.h>

#include "core/system/plain_text.h"

namespace carousel {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view kBuildMark = "carousel module of build ";

/// A module that this version can use: the package that holds it, and the package to build it with.
struct Known {
  const char *name, *package, *development;
};
constexpr std::array kKnown{
    Known{"http", "carousel-http", "libcpp-httplib-dev"},
    Known{"mpi", "carousel-mpi", "libopenmpi-dev"},
    Known{"pictures", "carousel-pictures", "libopenimageio-dev"},
    Known{"scenes", "carousel-scenes", "libassimp-dev"},
};

/// How to get a module.
std::string remedy(const std::string& name) {
  const auto known = std::find_if(kKnown.begin(), kKnown.end(), [&](const Known& k) { return name == k.name; });
  if (known == kKnown.end()) return "";
  return fmt::format("; Debian's package {} brings it, and so does a build with {} installed", known->package,
                     known->development);
}

/// A module_build() without the words around it.
std::string bare(std::string_view build) {
  build.remove_prefix(std::min(kBuildMark.size(), build.size()));
  return plain_text(build.substr(0, build.find('\n')));
}

struct Opened {
  const ModuleInfo* info = nullptr;
  std::string fault;
};

Opened open_file(const fs::path& file, const std::string& name) {
  if (std::string fault = build_fault(file, "module"); !fault.empty()) return {nullptr, fault};
  // Names stay the module's own (RTLD_LOCAL); it is never closed, as objects that it made may live on.
  void* library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
  if (library == nullptr) return {nullptr, plain_text(dlerror())};
  const auto tell = reinterpret_cast<decltype(&carousel_module)>(dlsym(library, "carousel_module"));
  if (tell == nullptr) return {nullptr, "it does not export carousel_module"};
  const ModuleInfo* info = tell();
  if (info == nullptr || info->magic != ModuleInfo::kMagic || std::strcmp(info->build, module_build()) != 0)
    return {nullptr, "it does not tell its build"};
  if (name != info->name) return {nullptr, fmt::format("it calls itself {}", plain_text(info->name))};
  return {info, ""};
}

/// Opens a file once in a process.
const Opened& open_once(const fs::path& file, const std::string& name) {
  static std::mutex mutex;
  static std::map<fs::path, Opened> opened;
  const std::lock_guard lock(mutex);
  const auto found = opened.find(file);
  return found != opened.end() ? found->second : opened.emplace(file, open_file(file, name)).first->second;
}

fs::path file_of(const std::string& name) {
  return module_folder() / (name + ".so");
}

fs::path existing_file_of(const std::string& name) {
  const fs::path file = file_of(name);
  std::error_code error;
  if (fs::exists(file, error)) return file;
  throw ModuleError(fmt::format("the module {} is not there: {} does not exist{}", name, file.string(), remedy(name)));
}

[[noreturn]] void refuse(const std::string& name, const fs::path& file, const std::string& fault) {
  throw ModuleError(fmt::format("the module {} cannot be opened: {}: {}{}", name, file.string(), fault, remedy(name)));
}

}  // namespace

std::string build_fault(const fs::path& file, std::string_view what) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) return "it is no file";
  std::ifstream in(file, std::ios::binary);
  if (!in) return std::strerror(errno);
  const std::string bytes{std::istreambuf_iterator<char>(in), {}};
  if (bytes.find(module_build()) != bytes.npos) return "";
  const std::size_t at = bytes.find(kBuildMark);
  if (at == bytes.npos) return fmt::format("it is no {} of Carousel", what);
  return fmt::format("it is of the build {}; expected that of this program, {}", bare(bytes.substr(at, 256)),
                     bare(module_build()));
}

fs::path module_folder() {
  if (const char* chosen = std::getenv("CAROUSEL_MODULES"); chosen != nullptr && *chosen != '\0') return chosen;
  std::error_code error;
  const fs::path folder = fs::read_symlink("/proc/self/exe", error).parent_path();
  // CMake leaves this file in a build folder; test programs stand in a folder of it.
  for (const fs::path& build : {folder, folder.parent_path()})
    if (fs::exists(build / "CMakeCache.txt", error)) return build / "modules";
  return folder.parent_path() / "lib" / "carousel" / "modules";
}

fs::path module_file(const std::string& name) {
  const fs::path file = existing_file_of(name);
  if (const std::string fault = build_fault(file, "module"); !fault.empty()) refuse(name, file, fault);
  return file;
}

const ModuleInfo& open_module(const std::string& name) {
  const fs::path file = existing_file_of(name);
  const Opened& opened = open_once(file, name);
  if (opened.info == nullptr) refuse(name, file, opened.fault);
  return *opened.info;
}

std::vector<FoundModule> find_modules() {
  std::set<std::string> names;
  for (const Known& known : kKnown) names.insert(known.name);
  std::error_code error;
  for (fs::directory_iterator entry(module_folder(), error), end; !error && entry != end; entry.increment(error))
    if (entry->path().extension() == ".so") names.insert(entry->path().stem().string());
  std::vector<FoundModule> out;
  for (const std::string& name : names) {
    const fs::path file = file_of(name);
    if (!fs::exists(file, error)) {
      out.push_back({name, {}, "not there" + remedy(name), nullptr});
      continue;
    }
    const Opened& opened = open_once(file, name);
    out.push_back({name, file, opened.fault, opened.info});
  }
  return out;
}

}  // namespace carousel
