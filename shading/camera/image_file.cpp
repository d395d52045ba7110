#include "shading/camera/image_file.h"

#include <cmath>
#include <cstring>
#include <exception>
#include <string>
#include <vector>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfOutputFile.h>
#include <fmt/format.h>
#include <png.h>

#include "core/module/module.h"
#include "core/numeric/exponential.h"
#include "core/system/atomic_file.h"
#include "core/system/error.h"
#include "scene/images/picture_module.h"
#include "shading/camera/tone_curve.h"
#include "shading/math/srgb.h"

namespace carousel::shading {

namespace {

[[noreturn]] void fail(const std::filesystem::path& path, const char* why) {
  throw FileError(fmt::format("cannot encode {}: {}", path.string(), why));
}

/// Keeps the file that OpenEXR writes in memory, from where AtomicFile writes it.
class MemoryStream : public Imf::OStream {
 public:
  MemoryStream() : OStream("memory") {}
  void write(const char data[], int count) override {
    const auto size = static_cast<std::size_t>(count);
    if (bytes_.size() < at_ + size) bytes_.resize(at_ + size);
    std::memcpy(&bytes_[at_], data, size);
    at_ += size;
  }
  std::uint64_t tellp() override { return at_; }
  void seekp(std::uint64_t at) override { at_ = at; }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
  std::size_t at_ = 0;
};

std::vector<std::uint8_t> display_pixels(std::span<const float> rgb, float exposure) {
  const float factor = exp2_float(double{exposure});
  std::vector<std::uint8_t> pixels(rgb.size());
  for (std::size_t i = 0; i < rgb.size(); i += 3) {
    const Vec3 color = tone_curve(factor * Vec3{rgb[i], rgb[i + 1], rgb[i + 2]});
    for (std::size_t c = 0; c < 3; ++c) {
      pixels[i + c] = static_cast<std::uint8_t>(linear_to_srgb(color[static_cast<int>(c)]) * 255.0f + 0.5f);
    }
  }
  return pixels;
}

bool needs_module(PictureFile format) {
  return format != PictureFile::kPng && format != PictureFile::kExr;
}

}  // namespace

void write_png(const std::filesystem::path& path, std::uint32_t width, std::uint32_t height, std::span<const float> rgb,
               float exposure) {
  write_png_bytes(path, width, height, display_pixels(rgb, exposure));
}

void write_png_bytes(const std::filesystem::path& path, std::uint32_t width, std::uint32_t height,
                     std::span<const std::uint8_t> rgb) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = width;
  image.height = height;
  image.format = PNG_FORMAT_RGB;  // eight bits a channel, sRGB
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::string bytes(size, '\0');
  if (png_image_write_to_memory(&image, bytes.data(), &size, 0, rgb.data(), 0, nullptr) == 0) fail(path, image.message);
  write_file(path, {bytes.data(), size});
}

void write_exr(const std::filesystem::path& path, std::uint32_t width, std::uint32_t height,
               std::span<const float> rgb) {
  MemoryStream memory;
  try {
    Imf::Header header(static_cast<int>(width), static_cast<int>(height));
    header.compression() = Imf::ZIP_COMPRESSION;
    Imf::FrameBuffer channels;
    constexpr std::size_t kPixel = 3 * sizeof(float);
    for (std::size_t c = 0; c < 3; ++c) {
      const std::string name(1, "RGB"[c]);
      header.channels().insert(name, Imf::Channel(Imf::FLOAT));
      // OpenEXR reads through a pointer that is not const.
      auto* first = reinterpret_cast<char*>(const_cast<float*>(rgb.data() + c));
      channels.insert(name, Imf::Slice(Imf::FLOAT, first, kPixel, kPixel * width));
    }
    Imf::OutputFile file(memory, header, 0);
    file.setFrameBuffer(channels);
    file.writePixels(static_cast<int>(height));
  } catch (const std::exception& e) {
    fail(path, e.what());
  }
  write_file(path, memory.bytes());
}

void write_picture(const std::filesystem::path& path, PictureFile format, std::uint32_t width, std::uint32_t height,
                   std::span<const float> rgb, float exposure) {
  if (format == PictureFile::kPng) return write_png(path, width, height, rgb, exposure);
  if (format == PictureFile::kExr) return write_exr(path, width, height, rgb);
  std::string bytes;
  try {
    bytes = open_module<scene::PictureModule>().write(std::string(enum_name(format)), width, height, rgb,
                                                      display_pixels(rgb, exposure));
  } catch (const std::exception& e) {
    fail(path, e.what());
  }
  write_file(path, bytes);
}

void require_picture_files(const std::vector<PictureFile>& formats) {
  for (const PictureFile format : formats) {
    if (!needs_module(format)) continue;
    const std::string name(enum_name(format));
    try {
      if (open_module<scene::PictureModule>().writes(name)) continue;
    } catch (const ModuleError& e) {
      throw ConfigError("image.files", fmt::format("{}; expected png or exr, found {}", e.what(), name));
    }
    throw ConfigError("image.files",
                      fmt::format("the OpenImageIO of the module pictures was built without this format; "
                                  "expected another one, found {}",
                                  name));
  }
}

}  // namespace carousel::shading
