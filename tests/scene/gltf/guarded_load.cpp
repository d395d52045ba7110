#include "tests/scene/gltf/guarded_load.h"

#include <csignal>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <memory>
#include <stdexcept>

#include <nlohmann/json.hpp>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "core/system/error.h"

namespace carousel::scene {

namespace {

using Json = nlohmann::json;
using End = LoadOutcome::End;

constexpr rlim_t kMostGrowth = rlim_t{256} << 20;

std::string fault_of(const Scene& scene) {
  for (const Mesh& mesh : scene.meshes) {
    for (const std::uint32_t i : mesh.indices)
      if (i >= mesh.positions.size()) return "an index is beyond the positions";
    if (mesh.triangle_materials.size() != mesh.triangle_count()) return "not every triangle has a material";
    for (const MaterialId id : mesh.triangle_materials)
      if (id.value >= scene.materials.size()) return "a triangle's material does not exist";
  }
  for (const Instance& instance : scene.instances)
    if (instance.mesh.value >= scene.meshes.size()) return "an instance's mesh does not exist";
  return scene.cameras.empty() ? "no camera" : "";
}

LoadOutcome load_one(std::size_t index, const std::function<Scene(std::size_t)>& load) {
  try {
    const std::string fault = fault_of(load(index));
    return {fault.empty() ? End::kLoaded : End::kFault, "", fault};
  } catch (const SceneError& e) {
    const bool greedy = e.message().starts_with("not enough memory");
    return {greedy || e.message().empty() ? End::kFault : End::kRefused, e.json_path(), e.message()};
  } catch (const std::exception& e) {
    return {End::kFault, "", std::string("another exception: ") + e.what()};
  }
}

void limit_memory() {
  if (!kMemoryIsGuarded) return;
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (!line.starts_with("VmData:")) continue;
    const rlim_t bytes = (std::stoull(line.substr(7)) << 10) + kMostGrowth;
    const rlimit limit{bytes, bytes};
    setrlimit(RLIMIT_DATA, &limit);
  }
}

/// The child: one line of JSON an outcome, from `begin` on.
[[noreturn]] void load_all(int pipe, std::size_t begin, std::size_t count,
                           const std::function<Scene(std::size_t)>& load, unsigned seconds) {
  limit_memory();
  for (std::size_t i = begin; i < count; ++i) {
    alarm(seconds);  // also ends a wait that takes no processor time
    const LoadOutcome outcome = load_one(i, load);
    const Json line = {static_cast<int>(outcome.end), outcome.path, outcome.message};
    // Messages may quote text that is not UTF-8.
    const std::string text = line.dump(-1, ' ', false, Json::error_handler_t::replace) + '\n';
    if (write(pipe, text.data(), text.size()) != static_cast<ssize_t>(text.size())) _exit(1);
  }
  _exit(0);  // the parent's streams must not be closed or flushed twice
}

std::string death(int status) {
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGALRM) return "it takes too long";
  if (WIFSIGNALED(status)) return std::string("killed: ") + strsignal(WTERMSIG(status));
  return "the process ended with status " + std::to_string(WEXITSTATUS(status));
}

}  // namespace

std::ostream& operator<<(std::ostream& out, const LoadOutcome& outcome) {
  constexpr const char* kEnds[] = {"loaded", "refused", "FAULT"};
  return out << kEnds[static_cast<int>(outcome.end)] << " \"" << outcome.path << "\": " << outcome.message;
}

std::vector<LoadOutcome> load_guarded(std::size_t count, const std::function<Scene(std::size_t)>& load,
                                      unsigned seconds) {
  std::vector<LoadOutcome> out;
  while (out.size() < count) {
    int ends[2];
    if (pipe(ends) != 0) throw std::runtime_error("no pipe");
    std::fflush(nullptr);
    const pid_t child = fork();
    if (child < 0) throw std::runtime_error("no process");
    if (child == 0) load_all(ends[1], out.size(), count, load, seconds);
    close(ends[1]);
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> lines(fdopen(ends[0], "r"), std::fclose);
    char* text = nullptr;
    std::size_t room = 0;
    while (getline(&text, &room, lines.get()) > 0) {
      const Json line = Json::parse(text);
      out.push_back({static_cast<End>(line[0].get<int>()), line[1], line[2]});
    }
    std::free(text);
    int status = 0;
    waitpid(child, &status, 0);
    // The next model ended the child; the others get a new one.
    if (out.size() < count) out.push_back({End::kFault, "", death(status)});
  }
  return out;
}

}  // namespace carousel::scene
