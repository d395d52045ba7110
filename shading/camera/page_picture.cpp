#include "shading/camera/page_picture.h"

#include <algorithm>
#include <cstdint>
#include <fstream>
#include <iterator>
#include <memory>
#include <vector>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagebufalgo.h>

namespace carousel::shading {

std::optional<PagePicture> page_picture(const std::filesystem::path& png) {
  constexpr std::size_t kMostBytes = 1'000'000;
  constexpr int kMostWidth = 1600;
  std::ifstream in(png, std::ios::binary);
  if (!in) return std::nullopt;
  std::string bytes{std::istreambuf_iterator<char>(in), {}};
  if (bytes.size() <= kMostBytes) return PagePicture{"image/png", std::move(bytes)};

  OIIO::ImageBuf picture(png.string());
  if (!picture.read(0, 0, true, OIIO::TypeDesc::UINT8)) return std::nullopt;
  if (const OIIO::ImageSpec& spec = picture.spec(); spec.width > kMostWidth) {
    const OIIO::ROI small(0, kMostWidth, 0, std::max(1, spec.height * kMostWidth / spec.width), 0, 1, 0, 3);
    picture = OIIO::ImageBufAlgo::resize(picture, "", 0.0f, small);
  }
  OIIO::ImageSpec spec(picture.spec().width, picture.spec().height, 3, OIIO::TypeDesc::UINT8);
  spec.attribute("Compression", "jpeg:90");
  std::vector<std::uint8_t> pixels(spec.image_pixels() * 3);
  std::vector<unsigned char> jpeg;
  OIIO::Filesystem::IOVecOutput memory(jpeg);
  const std::unique_ptr<OIIO::ImageOutput> file = OIIO::ImageOutput::create("image.jpg", &memory);
  const OIIO::ROI whole(0, spec.width, 0, spec.height, 0, 1, 0, 3);
  if (!picture.get_pixels(whole, OIIO::TypeDesc::UINT8, pixels.data()) || !file || !file->open("image.jpg", spec) ||
      !file->write_image(OIIO::TypeDesc::UINT8, pixels.data()) || !file->close())
    return std::nullopt;
  return PagePicture{"image/jpeg", {reinterpret_cast<const char*>(jpeg.data()), jpeg.size()}};
}

}  // namespace carousel::shading
