#include "scene/import/import_file.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdint>
#include <fstream>
#include <functional>
#include <iterator>
#include <new>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/module/module.h"
#include "core/system/error.h"
#include "core/system/plain_text.h"
#include "core/system/stop_request.h"
#include "scene/images/image_decode.h"
#include "scene/images/read_at_once.h"
#include "scene/import/ply_check.h"
#include "scene/import/wire.h"

namespace carousel::scene {

namespace {

namespace fs = std::filesystem;

/// Seconds of the processor that the module gets for a file: one for a small one, ten for one of a MiB, and one for
/// each further MiB. A library that loops over a damaged file of some kilobytes is not waited for longer.
std::uint32_t seconds_for(std::uint64_t bytes) {
  constexpr std::uint64_t kLeast = 1, kOfMiB = 10, kMost = 100'000;
  const std::uint64_t small = std::min(kOfMiB, kLeast + (bytes * (kOfMiB - kLeast) >> 20));
  return static_cast<std::uint32_t>(std::min(small + (bytes >> 20), kMost));
}

/// Which images are colours, by their use.
std::vector<bool> read_as_colors(const Scene& scene) {
  std::vector<bool> out(scene.images.size(), true);
  for (const Material& material : scene.materials)
    for (const auto* use : {&material.normal_texture, &material.metallic_roughness_texture})
      if (*use) out[scene.textures[(*use)->texture.value].image.value] = false;
  return out;
}

/// A picture that the model names: its bytes, or those of a file in the model's folder or one of the two above it.
Image read_picture(const fs::path& model, Imported::Image& from, bool color, MemoryBudget& memory) {
  const auto fail = [&](const std::string& why) {
    throw SceneError(model.string(), "", (from.place.empty() ? "" : from.place + ": ") + why);
  };
  Image out;
  try {
    if (from.width > 0) {
      if (from.bytes.size() != std::uint64_t{4} * from.width * from.height) fail("the image has not all its pixels");
      out.width = from.width;
      out.height = from.height;
      out.rgba = std::move(from.bytes);
      return out;
    }
    const PictureHint hint{from.file, color};
    if (from.file.empty()) return decode_image(from.bytes, memory, hint);
    const fs::path root = fs::weakly_canonical(model).parent_path().parent_path().parent_path();
    const fs::path real = fs::weakly_canonical(from.file);
    if (std::mismatch(root.begin(), root.end(), real.begin(), real.end()).first != root.end())
      fail("the image " + from.file + " is outside the model's folder and the two above it");
    std::ifstream in(real, std::ios::binary);
    std::error_code error;
    const std::uintmax_t size = fs::file_size(real, error);
    if (!in || error) fail("the image " + from.file + " cannot be read");
    const MemoryBudget::Loan loan = memory.lend(size);
    const std::vector<unsigned char> bytes{std::istreambuf_iterator<char>(in), {}};
    return decode_image(bytes, memory, hint);
  } catch (const SceneError&) {
    throw;
  } catch (const Interrupted&) {
    throw;
  } catch (const fs::filesystem_error& e) {
    fail("the image " + from.file + " cannot be read: " + e.code().message());
  } catch (const std::length_error& e) {
    fail(std::string("the image ") + e.what());
  } catch (const std::runtime_error& e) {
    fail("the image " + fs::path(from.file).filename().string() + " is " + e.what());
  }
  return out;
}

/// Calls `body`, and gives its errors the name of the file.
template <class Body>
auto with_errors_of(const fs::path& file, const Body& body) {
  const auto fail = [&](const std::string& why) { return SceneError(file.string(), "", why); };
  try {
    return body();
  } catch (const std::bad_alloc&) {
    throw fail("not enough memory to load it");
  } catch (const std::length_error& too_much) {
    throw fail(std::string("the file ") + too_much.what());
  } catch (const Interrupted&) {
    throw;
  } catch (const ConfigError&) {
    throw;
  } catch (const FileError&) {
    throw;
  } catch (const SceneError&) {
    throw;
  } catch (const std::runtime_error& e) {
    throw fail(e.what());
  }
}

}  // namespace

bool is_gltf(const fs::path& file) {
  std::string ending = file.extension().string();
  std::ranges::transform(ending, ending.begin(), [](unsigned char c) { return c < 128 ? std::tolower(c) : c; });
  if (ending == ".gltf" || ending == ".glb") return true;
  std::ifstream in(file, std::ios::binary);
  std::array<char, 64> begin{};
  in.read(begin.data(), begin.size());
  const std::string_view text(begin.data(), static_cast<std::size_t>(in.gcount()));
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  return text.starts_with("glTF") || (first != text.npos && text[first] == '{');
}

Imported SceneImporter::ask(const fs::path& file, MemoryBudget& memory, bool posed, bool files_only) {
  std::error_code error;
  if (!fs::is_regular_file(file, error)) throw SceneError(file.string(), "", "no such file");
  const std::uintmax_t size = fs::file_size(file, error);
  if (error) throw SceneError(file.string(), "", "cannot be read");
  check_ply(file, size);
  const std::function<void(std::uint64_t)> take = [&](std::uint64_t bytes) { memory.take(bytes); };
  ImportQuestion question{memory.left(), seconds_for(size), fs::absolute(file).lexically_normal().string(), posed,
                          files_only};
  std::string text;
  WireWriter{text}(question);
  const std::array<std::string_view, 1> parts{text};
  const std::vector<unsigned char> answer = process_.ask(parts, take);
  Imported out;
  WireReader reader(answer, take);
  reader(out);
  if (!reader.at_end() || out.version != Imported::kVersion) throw std::runtime_error("not the answer of a module");
  return out;
}

Scene SceneImporter::load(const fs::path& file, const WarningSink& warn, const ImageChoice& images,
                          const std::optional<PoseChoice>& pose, Executor* executor) {
  return with_errors_of(file, [&] {
    MemoryBudget memory(MemoryBudget::of_process());
    Imported imported = ask(file, memory, pose.has_value(), false);
    std::vector<Imported::Image> pictures = std::move(imported.images);
    imported.images.resize(pictures.size());
    for (std::size_t i = 0; i < pictures.size(); ++i) imported.images[i].name = plain_text(pictures[i].name);
    Scene scene = scene_of(std::move(imported), file, warn, memory, pose);
    const std::vector<bool> wanted = images ? images(scene) : std::vector<bool>(scene.images.size(), true);
    const std::vector<bool> color = read_as_colors(scene);
    std::vector<std::size_t> left;
    for (std::size_t i = 0; i < pictures.size(); ++i)
      if (wanted.at(i)) left.push_back(i);
    read_at_once(executor, std::move(left), [&](std::size_t i) {
      Image image = read_picture(file, pictures[i], color[i], memory);
      image.name = std::move(scene.images[i].name);
      scene.images[i] = std::move(image);
    });
    return scene;
  });
}

std::vector<fs::path> SceneImporter::files_of(const fs::path& file) {
  return with_errors_of(file, [&] {
    MemoryBudget memory(MemoryBudget::of_process());
    const Imported imported = ask(file, memory, false, true);
    return std::vector<fs::path>(imported.files.begin(), imported.files.end());
  });
}

}  // namespace carousel::scene
