#include "shading/image_file.h"

#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include "core/error.h"
#include "shading/srgb.h"
#include "shading/tone_curve.h"

namespace carousel::shading {

namespace {

/// Removes what was not renamed.
class TemporaryFile {
 public:
  explicit TemporaryFile(const std::filesystem::path& target) : target_(target), path_(target) {
    // The format is told from the extension, so that stays last.
    path_.replace_filename(target.stem().string() + ".tmp" + target.extension().string());
  }
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() {
    std::error_code ignored;
    if (!renamed_) std::filesystem::remove(path_, ignored);
  }
  const std::filesystem::path& path() const { return path_; }
  void rename() {
    std::error_code error;
    std::filesystem::rename(path_, target_, error);
    if (error) throw FileError(fmt::format("cannot write {}: {}", target_.string(), error.message()));
    renamed_ = true;
  }

 private:
  std::filesystem::path target_, path_;
  bool renamed_ = false;
};

void write(const std::filesystem::path& path, const OIIO::ImageSpec& spec, OIIO::TypeDesc type,
           const void* pixels) {
  TemporaryFile temporary(path);
  auto fail = [&](const std::string& why) {
    throw FileError(fmt::format("cannot write {}: {}", path.string(), why));
  };
  const std::unique_ptr<OIIO::ImageOutput> file = OIIO::ImageOutput::create(temporary.path().string());
  if (!file) fail(OIIO::geterror());
  if (!file->open(temporary.path().string(), spec)) fail(file->geterror());
  if (!file->write_image(type, pixels)) fail(file->geterror());
  if (!file->close()) fail(file->geterror());
  temporary.rename();
}

}  // namespace

void write_png(const std::filesystem::path& path, std::uint32_t width, std::uint32_t height,
               std::span<const float> rgb) {
  std::vector<std::uint8_t> pixels(rgb.size());
  for (std::size_t i = 0; i < rgb.size(); i += 3) {
    const Vec3 color = tone_curve({rgb[i], rgb[i + 1], rgb[i + 2]});
    for (std::size_t c = 0; c < 3; ++c) {
      pixels[i + c] = static_cast<std::uint8_t>(linear_to_srgb(color[static_cast<int>(c)]) * 255.0f + 0.5f);
    }
  }
  OIIO::ImageSpec spec(static_cast<int>(width), static_cast<int>(height), 3, OIIO::TypeDesc::UINT8);
  spec.attribute("oiio:ColorSpace", "sRGB");
  write(path, spec, OIIO::TypeDesc::UINT8, pixels.data());
}

void write_exr(const std::filesystem::path& path, std::uint32_t width, std::uint32_t height,
               std::span<const float> rgb) {
  OIIO::ImageSpec spec(static_cast<int>(width), static_cast<int>(height), 3, OIIO::TypeDesc::FLOAT);
  spec.attribute("oiio:ColorSpace", "Linear");
  spec.attribute("compression", "zip");
  write(path, spec, OIIO::TypeDesc::FLOAT, rgb.data());
}

}  // namespace carousel::shading
