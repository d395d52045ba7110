#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/system/error.h"

namespace carousel {

/// The description that a module gives of itself. A module is a shared library `NAME.so` that the program opens when it
/// first needs it: glue between a large library of others and a struct of functions, its interface, which a header of
/// the program declares. docs/how-it-works/modules.md has the rules. The first two members stay where they are in all
/// versions.
struct ModuleInfo {
  static constexpr std::uint64_t kMagic = 0x6c75646f4d726143;  ///< "CarModul", in memory on a little-endian machine

  std::uint64_t magic = kMagic;
  const char* build = nullptr;         ///< module_build() of the module
  const char* name = nullptr;          ///< the name of its file, without .so
  const char* brings = nullptr;        ///< for a list: "pictures of 20 formats"
  std::string (*library)() = nullptr;  ///< the library under it, with the version that was loaded
  const void* functions = nullptr;     ///< the struct whose kModule is the name; lives for ever
  std::string (*answer)(std::string_view question) = nullptr;  ///< for module_process.h; may throw std::exception
};

/// The build that this program, or this module, is of: version, commit, compiler, kind. Interfaces hold C++ types of
/// the program, so that a module works with the build that it was made with, and with no other. The text stands in the
/// module's file, where the program finds it before any code of the module runs.
const char* module_build();

/// A module is not there, is of another build, or a library that it needs cannot be loaded. The message names the
/// module, its file or the folder, the reason, and the package that brings it. Exit status 2.
class ModuleError : public FileError {
 public:
  using FileError::FileError;
};

/// Why a file cannot be opened as a part of this program, `what` in messages: it is none, or is of another build. Empty
/// if it can be. Runs nothing of it: a library's constructors run when it is opened, and those of another build may do
/// anything.
std::string build_fault(const std::filesystem::path& file, std::string_view what);

/// The folder with the modules of this program: `CAROUSEL_MODULES` of the environment if it is set, else `modules` in
/// the build folder, or `lib/carousel/modules` beside the folder of an installed program.
std::filesystem::path module_folder();

/// The file of a module, which is there and is of this build. Opens nothing. Throws ModuleError.
std::filesystem::path module_file(const std::string& name);

/// Opens a module, once; later calls return what the first has found, which stays open until the process ends. Any
/// thread. Throws ModuleError.
const ModuleInfo& open_module(const std::string& name);

/// The functions of a module, which it opens. `Functions::kModule` names the module. Throws ModuleError.
template <class Functions>
const Functions& open_module() {
  return *static_cast<const Functions*>(open_module(Functions::kModule).functions);
}

/// A module of the folder, or one that this version knows and that is not there.
struct FoundModule {
  std::string name;
  std::filesystem::path file;        ///< empty: it is not there
  std::string refused;               ///< why it cannot be opened; empty if it is open
  const ModuleInfo* info = nullptr;  ///< if it is open
};

/// All modules by name, which it opens: for `carousel --version --verbose`.
std::vector<FoundModule> find_modules();

}  // namespace carousel

/// The one name that a module exports, defined in its own source.
extern "C" [[gnu::visibility("default")]] const carousel::ModuleInfo* carousel_module();
