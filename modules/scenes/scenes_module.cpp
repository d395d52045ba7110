// The module "scenes": scene files other than glTF, read by Assimp.
#include <cstdint>
#include <fstream>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <string_view>

#include <assimp/version.h>
#include <sys/resource.h>

#include "core/module/module.h"
#include "modules/scenes/read_scene.h"
#include "scene/import/import_module.h"
#include "scene/import/imported.h"
#include "scene/import/wire.h"

namespace carousel::scenes {

namespace {

/// The bytes of addresses that this process has.
std::uint64_t address_space() {
  std::ifstream in("/proc/self/statm");
  std::uint64_t pages = 0;
  in >> pages;
  return pages * 4096;
}

void limit(int resource, std::uint64_t most) {
  rlimit now{};
  getrlimit(resource, &now);
  now.rlim_cur = std::min<std::uint64_t>(most, now.rlim_max);
  setrlimit(static_cast<__rlimit_resource>(resource), &now);
}

/// Seconds of the processor that this process has used.
std::uint64_t seconds_used() {
  rusage used{};
  getrusage(RUSAGE_SELF, &used);
  return static_cast<std::uint64_t>(used.ru_utime.tv_sec + used.ru_stime.tv_sec);
}

std::string library() {
  return "Assimp " + std::to_string(aiGetVersionMajor()) + "." + std::to_string(aiGetVersionMinor()) + "." +
         std::to_string(aiGetVersionPatch());
}

/// Answers an ImportQuestion with an Imported. A library that loops or takes all memory breaks this process alone, and
/// the soft limits say when.
std::string answer(std::string_view asked) {
  const std::function<void(std::uint64_t)> any = [](std::uint64_t) {};
  scene::ImportQuestion question;
  scene::WireReader(std::span(reinterpret_cast<const unsigned char*>(asked.data()), asked.size()), any)(question);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)  // which reserve addresses by the terabyte
  const std::uint64_t before = address_space();
  limit(RLIMIT_AS,
        question.bytes < std::numeric_limits<std::uint64_t>::max() - before ? before + question.bytes : RLIM_INFINITY);
#endif
  limit(RLIMIT_CPU, seconds_used() + 1 + question.seconds);
  scene::Imported imported = read_scene(question);
  std::string out;
  scene::WireWriter{out}(imported);
  return out;
}

}  // namespace

}  // namespace carousel::scenes

const carousel::ModuleInfo* carousel_module() {
  using namespace carousel;
  static constexpr scene::ImportModule kFunctions{scenes::endings};
  static const ModuleInfo info{.build = module_build(),
                               .name = scene::ImportModule::kModule,
                               .brings = "scenes in OBJ, FBX, PLY, STL, COLLADA and other formats",
                               .library = scenes::library,
                               .functions = &kFunctions,
                               .answer = scenes::answer};
  return &info;
}
