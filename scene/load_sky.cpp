#include "scene/load_sky.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <fstream>
#include <new>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "core/system/error.h"
#include "core/system/memory_budget.h"
#include "core/system/plain_text.h"
#include "scene/images/exr_decode.h"
#include "scene/images/hdr_decode.h"

namespace carousel::scene {

namespace {

/// Bytes that choosing from the map takes for each texel (shading/lights/sky_light.h).
constexpr std::uint64_t kChoiceBytes = 4;

std::vector<unsigned char> read_bytes(const std::filesystem::path& file, MemoryBudget& memory) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  std::ifstream stream(file, std::ios::binary);
  if (error || !stream) throw std::runtime_error("cannot be read");
  memory.take(size);
  std::vector<unsigned char> bytes(static_cast<std::size_t>(size));
  stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (static_cast<std::uintmax_t>(stream.gcount()) != size) throw std::runtime_error("reading failed");
  return bytes;
}

FloatImage decode(const std::filesystem::path& file) {
  MemoryBudget memory(MemoryBudget::of_process());
  const std::vector<unsigned char> bytes = read_bytes(file, memory);
  if (!is_hdr(bytes) && !is_exr(bytes))
    throw std::runtime_error("is no environment map: neither Radiance (.hdr) nor OpenEXR");
  FloatImage image = is_hdr(bytes) ? decode_hdr(bytes, memory) : decode_exr(bytes, memory);
  memory.take(std::uint64_t{image.width} * image.height * kChoiceBytes);
  return image;
}

/// Multiplies all texels by `strength`, and replaces those that are no light; a sentence about these, or none.
std::string make_light(std::vector<Vec3>& texels, float strength) {
  std::uint64_t dark = 0, bright = 0;
  float most = 0;
  const auto too_bright = [](float value) { return value > SkyMap::kMostRadiance; };
  const auto each = [&](const auto& treat) {
    for (Vec3& texel : texels)
      for (int c = 0; c < 3; ++c) treat(texel[c]);
  };
  each([&](float& value) {
    if (!(value >= 0)) {
      value = 0;
      ++dark;
      return;
    }
    value = strength == 0 ? 0.0f : value * strength;
    if (too_bright(value))
      ++bright;
    else
      most = std::max(most, value);
  });
  if (bright > 0)
    each([&](float& value) {
      if (too_bright(value)) value = most;
    });
  if (dark + bright == 0) return "";
  return fmt::format(
      "of {} values {} are NaN or negative and count as 0, and {} are infinite or above {:.0e} and take {}, the "
      "largest "
      "other one",
      3 * texels.size(), dark, bright, SkyMap::kMostRadiance, most);
}

}  // namespace

SkyMap load_sky_map(const std::filesystem::path& file, const SkyConfig& config, const WarningSink& warn) {
  const std::string name = file.string();
  try {
    FloatImage image = decode(file);
    const std::string replaced = make_light(image.pixels, config.strength);
    if (!replaced.empty() && warn) warn(name + ": " + replaced);
    const float turns = config.rotation / 360;
    return {plain_text(file.filename().string()), image.width, image.height, std::move(image.pixels),
            turns - std::floor(turns)};
  } catch (const std::bad_alloc&) {
    throw SceneError(name, "", "not enough memory to load it");
  } catch (const std::length_error& too_much) {
    throw SceneError(name, "", std::string("the picture ") + too_much.what());
  } catch (const std::runtime_error& fault) {
    throw SceneError(name, "", fault.what());
  }
}

}  // namespace carousel::scene
