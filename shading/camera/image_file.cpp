#include "shading/camera/image_file.h"

#include <cmath>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include "core/system/atomic_file.h"
#include "core/system/error.h"
#include "shading/camera/tone_curve.h"
#include "shading/math/srgb.h"

namespace carousel::shading {

namespace {

/// Encodes in memory; AtomicFile writes the result. `format` is a file extension.
void write(const std::filesystem::path& path, const std::string& format, const OIIO::ImageSpec& spec,
           OIIO::TypeDesc type, const void* pixels) {
  auto fail = [&](const std::string& why) { throw FileError(fmt::format("cannot encode {}: {}", path.string(), why)); };
  std::vector<unsigned char> bytes;
  OIIO::Filesystem::IOVecOutput memory(bytes);
  const std::unique_ptr<OIIO::ImageOutput> file = OIIO::ImageOutput::create("image." + format, &memory);
  if (!file) fail(OIIO::geterror());
  if (!file->open("image." + format, spec)) fail(file->geterror());
  if (!file->write_image(type, pixels)) fail(file->geterror());
  if (!file->close()) fail(file->geterror());
  write_file(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace

void write_png(const std::filesystem::path& path, std::uint32_t width, std::uint32_t height, std::span<const float> rgb,
               float exposure) {
  const float factor = std::exp2(exposure);
  std::vector<std::uint8_t> pixels(rgb.size());
  for (std::size_t i = 0; i < rgb.size(); i += 3) {
    const Vec3 color = tone_curve(factor * Vec3{rgb[i], rgb[i + 1], rgb[i + 2]});
    for (std::size_t c = 0; c < 3; ++c) {
      pixels[i + c] = static_cast<std::uint8_t>(linear_to_srgb(color[static_cast<int>(c)]) * 255.0f + 0.5f);
    }
  }
  OIIO::ImageSpec spec(static_cast<int>(width), static_cast<int>(height), 3, OIIO::TypeDesc::UINT8);
  spec.attribute("oiio:ColorSpace", "sRGB");
  write(path, "png", spec, OIIO::TypeDesc::UINT8, pixels.data());
}

void write_exr(const std::filesystem::path& path, std::uint32_t width, std::uint32_t height,
               std::span<const float> rgb) {
  OIIO::ImageSpec spec(static_cast<int>(width), static_cast<int>(height), 3, OIIO::TypeDesc::FLOAT);
  spec.attribute("oiio:ColorSpace", "Linear");
  spec.attribute("compression", "zip");
  write(path, "exr", spec, OIIO::TypeDesc::FLOAT, rgb.data());
}

}  // namespace carousel::shading
