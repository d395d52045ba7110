#include "core/plugin/open_plugin.h"

#include <algorithm>
#include <cstring>
#include <exception>
#include <fstream>
#include <iterator>
#include <map>
#include <memory>
#include <mutex>
#include <utility>

#include <dlfcn.h>
#include <fmt/format.h>

#include "core/numeric/bytes_digest.h"
#include "core/plugin/plugin.h"
#include "core/system/plain_text.h"
#include "core/types/added_names.h"

namespace carousel {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLongestName = 64;

bool is_part_name(std::string_view text) {
  return !text.empty() && text.size() <= kLongestName && text[0] >= 'a' && text[0] <= 'z' &&
         text.find_first_not_of("abcdefghijklmnopqrstuvwxyz0123456789_") == text.npos;
}

/// Keeps what a plugin brings until all of it is known to be right.
class TakenParts final : public PluginParts {
 public:
  struct Part {
    std::string what, name;
    std::shared_ptr<const void> body;
  };

  std::vector<Part> parts;
  std::string fault;  ///< the first; empty: none

 private:
  void take(std::string_view what, std::string name, bool taken, std::shared_ptr<const void> body) override {
    const auto refuse = [&](const std::string& why) {
      if (fault.empty()) fault = why;
    };
    const std::string shown = plain_text(name.substr(0, kLongestName));
    if (!is_part_name(name))
      return refuse(fmt::format("it calls a {} '{}'; expected at most {} of a-z, 0-9 and _, a letter first", what,
                                shown, kLongestName));
    if (taken) return refuse(fmt::format("it brings a {} of the name {}, which the program has", what, shown));
    if (std::any_of(parts.begin(), parts.end(), [&](const Part& p) { return p.what == what && p.name == name; }))
      return refuse(fmt::format("it brings two of {} {}", what, shown));
    if (body == nullptr) return refuse(fmt::format("it brings nothing as {} {}", what, shown));
    parts.push_back({std::string(what), std::move(name), std::move(body)});
  }
};

struct OpenedPlugin {
  Plugin plugin;
  std::string fault;
};

std::string told_text(const char* text) {
  return text == nullptr ? "" : plain_text(std::string_view(text).substr(0, 256));
}

/// Why a plugin that has told what it is cannot be used; empty if it can.
std::string plugin_fault(const PluginInfo* info) {
  if (info == nullptr || info->magic != PluginInfo::kMagic || info->build == nullptr ||
      std::strcmp(info->build, module_build()) != 0)
    return "it does not tell its build";
  if (told_text(info->compiler) != kPluginCompiler)
    return fmt::format("it is compiled by {}; expected {}, as the program is", told_text(info->compiler),
                       kPluginCompiler);
  if (info->ray_bytes != PluginInfo{}.ray_bytes) return "its rays are of another size than the program's";
  if (told_text(info->name).empty() || told_text(info->version).empty() || info->bring == nullptr)
    return "it does not tell name, version and what it brings";
  return "";
}

OpenedPlugin open_plugin_file(const fs::path& file) {
  OpenedPlugin out;
  out.plugin.file = file;
  const auto refuse = [&](std::string why) {
    out.fault = std::move(why);
    return std::move(out);
  };
  if (std::string fault = build_fault(file, "plugin"); !fault.empty()) return refuse(std::move(fault));
  std::ifstream in(file, std::ios::binary);
  out.plugin.digest = bytes_digest(std::string{std::istreambuf_iterator<char>(in), {}});
  // Never closed, as objects that it made may live on.
  void* library = dlopen(file.c_str(), RTLD_NOW | RTLD_LOCAL | RTLD_NODELETE);
  if (library == nullptr) return refuse(plain_text(dlerror()));
  const auto tell = reinterpret_cast<decltype(&carousel_plugin)>(dlsym(library, "carousel_plugin"));
  if (tell == nullptr) return refuse("it does not export carousel_plugin");
  TakenParts taken_parts;
  try {
    const PluginInfo* info = tell();
    if (std::string fault = plugin_fault(info); !fault.empty()) return refuse(std::move(fault));
    out.plugin.name = told_text(info->name);
    out.plugin.version = told_text(info->version);
    info->bring(taken_parts);
  } catch (const std::exception& error) {
    return refuse(fmt::format("it gives up: {}", plain_text(error.what())));
  }
  if (!taken_parts.fault.empty()) return refuse(taken_parts.fault);
  if (taken_parts.parts.empty()) return refuse("it brings nothing");
  for (TakenParts::Part& part : taken_parts.parts) {
    out.plugin.parts.push_back({part.what, part.name});
    add_named(part.what, Added{part.name, file.string(), std::move(part.body)});
  }
  return out;
}

}  // namespace

const Plugin& open_plugin(const fs::path& file) {
  static std::mutex mutex;
  static std::map<fs::path, OpenedPlugin> opened;
  const std::lock_guard lock(mutex);
  auto found = opened.find(file);  // one that is open may be gone since
  if (found == opened.end()) {
    std::error_code error;
    const fs::path real = fs::canonical(file, error);
    if (error) throw PluginError(fmt::format("the plugin {} is not there: {}", file.string(), error.message()));
    found = opened.find(real);
    if (found == opened.end()) found = opened.emplace(real, open_plugin_file(real)).first;
  }
  if (!found->second.fault.empty())
    throw PluginError(fmt::format("the plugin {} cannot be opened: {}", found->first.string(), found->second.fault));
  return found->second.plugin;
}

fs::path plugin_file(const fs::path& folder, const std::string& name) {
  const fs::path beside = folder / name;
  std::error_code error;
  return fs::exists(beside, error) ? beside : fs::path(name);
}

}  // namespace carousel
