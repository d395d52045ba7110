#include "app/sweep/plan/content.h"

#include <cerrno>
#include <cstring>
#include <iterator>
#include <vector>

#include <nlohmann/json.hpp>

#include "app/host/program_info.h"
#include "app/run/prepare.h"
#include "core/module/module.h"
#include "core/numeric/bytes_digest.h"
#include "core/system/error.h"
#include "core/system/input_file.h"
#include "scene/import/gaussian_ply.h"
#include "scene/import/import_file.h"

namespace carousel::app {

namespace {

std::string read_all(const std::filesystem::path& path) {
  // A device such as /dev/zero has no end.
  if (std::error_code ignored; std::filesystem::is_character_file(path, ignored))
    throw FileError("cannot read " + path.string() + ": expected a plain file, found a device");
  InputFile in(path);
  if (!in) throw FileError("cannot read " + path.string() + ": " + std::strerror(errno));
  return {std::istreambuf_iterator<char>(in), {}};
}

std::string percent_decoded(const std::string& text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const bool coded = text[i] == '%' && i + 2 < text.size() &&
                       std::isxdigit(static_cast<unsigned char>(text[i + 1])) &&
                       std::isxdigit(static_cast<unsigned char>(text[i + 2]));
    out += coded ? static_cast<char>(std::stoi(text.substr(i + 1, 2), nullptr, 16)) : text[i];
    if (coded) i += 2;
  }
  return out;
}

/// The JSON of a glTF file: the file itself, or the first chunk of a binary one (glTF 2.0, section 4.4).
nlohmann::json gltf_json(const std::string& bytes) {
  const auto word = [&](std::size_t at) {
    std::uint32_t value = 0;
    std::memcpy(&value, bytes.data() + at, 4);
    return value;
  };
  std::string text = bytes;
  if (bytes.size() >= 20 && bytes.compare(0, 4, "glTF") == 0)
    text = bytes.substr(20, std::min<std::size_t>(word(12), bytes.size() - 20));
  return nlohmann::json::parse(text, nullptr, false);  // the import reports what is wrong with it
}

/// The files beside a glTF file that it names.
std::vector<std::filesystem::path> named_in_gltf(const std::filesystem::path& path, const std::string& bytes) {
  std::vector<std::filesystem::path> out;
  const nlohmann::json json = gltf_json(bytes);
  for (const char* list : {"buffers", "images"}) {
    if (!json.is_object() || !json.contains(list) || !json[list].is_array()) continue;
    for (const nlohmann::json& entry : json[list]) {
      if (!entry.is_object() || !entry.contains("uri") || !entry["uri"].is_string()) continue;
      const std::string uri = entry["uri"];
      if (uri.rfind("data:", 0) != 0) out.push_back(path.parent_path() / percent_decoded(uri));
    }
  }
  return out;
}

/// The files that a scene of another format names: the module that reads it knows them. The import reports what is
/// wrong with the file or the module.
std::vector<std::filesystem::path> named_in_other(const std::filesystem::path& path) {
  if (scene::is_gaussian_ply(path)) return {};
  try {
    std::vector<std::filesystem::path> out = scene::SceneImporter().files_of(path);
    if (!out.empty()) out.erase(out.begin());  // itself
    return out;
  } catch (const SceneError&) {
    return {};
  } catch (const ModuleError&) {
    return {};
  }
}

}  // namespace

const std::string& ContentDigests::of_file(const std::string& name) {
  std::string& digest = files_[name];
  if (!digest.empty()) return digest;
  const std::filesystem::path path = find_beside(folder_, name);
  require_plain(path);
  return digest = bytes_digest(read_all(path));
}

void ContentDigests::require_plain(const std::filesystem::path& path) const {
  std::error_code ignored;
  if (read_again_ && std::filesystem::is_fifo(path, ignored))
    throw FileError("cannot read " + path.string() + ": expected a plain file, found a pipe, which has one reader");
}

const std::string& ContentDigests::of_scene(const std::string& name) {
  std::string& digest = scenes_[name];
  if (!digest.empty()) return digest;
  const std::filesystem::path path = find_beside(folder_, name);
  require_plain(path);
  const std::string bytes = read_all(path);
  std::string all = bytes_digest(bytes);
  for (const std::filesystem::path& file : scene::is_gltf(path) ? named_in_gltf(path, bytes) : named_in_other(path)) {
    // A file that is missing is the import's to judge: of images it may need none.
    std::error_code ignored;
    all += std::filesystem::is_regular_file(file, ignored) ? bytes_digest(read_all(file)) : "missing";
  }
  return digest = bytes_digest(all);
}

std::string ContentDigests::of(const EngineConfig& engine, const SceneConfig& scene, const BvhConfig& bvh,
                               const WorkloadConfig& workload) {
  std::string out;
  for (const std::string& plugin : engine.plugins) out += of_file(plugin);
  if (workload.kind == WorkloadConfig::Kind::kTraffic) return out;
  if (workload.kind == WorkloadConfig::Kind::kMemoryTrace) return out + of_file(workload.memory_trace);
  if (!scene.file.empty()) out += of_scene(scene.file);
  if (scene.sky && !scene.sky->file.empty()) out += of_file(scene.sky->file);
  if (!bvh.file.empty()) out += of_file(bvh.file);
  if (workload.kind == WorkloadConfig::Kind::kRaysFrom) out += of_file(workload.rays_from);
  return out;
}

std::string program_identity() {
  const report::Program program = program_info();
  std::string out = program.version + " " + program.commit + (program.checked ? " checked" : "");
  const bool unknown = program.commit == "unknown" || program.commit.find("dirty") != std::string::npos;
  return unknown ? out + " " + bytes_digest(read_all("/proc/self/exe")) : out;
}

}  // namespace carousel::app
