#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "core/module/module.h"
#include "core/types/enum_names.h"
#include "core/types/workload.h"

// What a plugin includes: a shared library of others that `engine.plugins` names, and that brings values of keys by
// name (docs/guides/plugins.md). ringbus/plugin/bring.h has a function for each kind.

namespace carousel {

/// Takes in what a plugin brings.
class PluginParts {
 public:
  virtual ~PluginParts() = default;
  /// Adds a value to an enum with kAddedAs. `body` is of the type that the program expects of the enum.
  template <class E>
  void add(std::string name, std::shared_ptr<const void> body) {
    const bool taken = enum_value<E>(name).has_value();
    take(kAddedAs<E>, std::move(name), taken, std::move(body));
  }

 private:
  /// `taken`: a value of the program has this name.
  virtual void take(std::string_view what, std::string name, bool taken, std::shared_ptr<const void> body) = 0;
};

/// What the program and its plugins have to have in common besides the build, as the compiler of each sees it: a plugin
/// is compiled by others, who might use another compiler or other options.
inline constexpr std::string_view kPluginCompiler =
#ifdef CAROUSEL_CHECKED
    "compiler " __VERSION__ ", checked";
#else
    "compiler " __VERSION__;
#endif

/// The description that a plugin gives of itself. The first three members stay where they are in all versions.
struct PluginInfo {
  static constexpr std::uint64_t kMagic = 0x67756c506f726143;  ///< "CaroPlug", in memory on a little-endian machine

  std::uint64_t magic = kMagic;
  const char* build = nullptr;  ///< module_build() of the plugin
  const char* compiler = kPluginCompiler.data();
  std::size_t ray_bytes = sizeof(RayRequest) + sizeof(RayResult);
  const char* name = nullptr;                   ///< its own
  const char* version = nullptr;                ///< its own
  void (*bring)(PluginParts& parts) = nullptr;  ///< may throw std::exception, which refuses the plugin
};

/// For carousel_plugin() of a plugin: names, and the function that hands its parts over. The texts live for ever.
inline PluginInfo plugin(const char* name, const char* version, void (*bring)(PluginParts& parts)) {
  PluginInfo info;
  info.build = module_build();
  info.name = name;
  info.version = version;
  info.bring = bring;
  return info;
}

}  // namespace carousel

/// The one name that a plugin exports. What it returns lives for ever.
extern "C" [[gnu::visibility("default")]] const carousel::PluginInfo* carousel_plugin();
