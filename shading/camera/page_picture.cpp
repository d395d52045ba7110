#include "shading/camera/page_picture.h"

#include <array>
#include <cstdint>
#include <exception>
#include <fstream>
#include <iterator>
#include <utility>

#include <webp/encode.h>

#include "scene/images/image_decode.h"

namespace carousel::shading {

namespace {

/// The mean of each `step` by `step` pixels; what is left over at the right and the bottom goes.
scene::Image reduced(const scene::Image& from, std::uint32_t step) {
  scene::Image out;
  out.width = from.width / step;
  out.height = from.height / step;
  out.rgba.reserve(std::size_t{4} * out.width * out.height);
  for (std::size_t y = 0; y < out.height; ++y) {
    for (std::size_t x = 0; x < out.width; ++x) {
      std::array<std::uint32_t, 4> sum{};
      for (std::size_t row = y * step; row < (y + 1) * step; ++row)
        for (std::size_t i = 4 * (row * from.width + x * step), k = 0; k < std::size_t{4} * step; ++k)
          sum[k % 4] += from.rgba[i + k];
      for (const std::uint32_t s : sum)
        out.rgba.push_back(static_cast<std::uint8_t>((s + step * step / 2) / (step * step)));
    }
  }
  return out;
}

}  // namespace

std::optional<PagePicture> page_picture(const std::filesystem::path& png) {
  constexpr std::size_t kMostBytes = 1'000'000;
  constexpr std::uint32_t kMostWidth = 1600, kMostHeight = 16383;  // the second is WebP's
  constexpr float kQuality = 90;
  std::ifstream in(png, std::ios::binary);
  if (!in) return std::nullopt;
  std::string bytes{std::istreambuf_iterator<char>(in), {}};
  if (bytes.size() <= kMostBytes) return PagePicture{"image/png", std::move(bytes)};

  scene::Image picture;
  try {
    MemoryBudget memory(MemoryBudget::of_process());
    picture = scene::decode_image({reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()}, memory);
  } catch (const std::exception&) {
    return std::nullopt;
  }
  std::uint32_t step = 1;
  while (picture.width / step > kMostWidth || picture.height / step > kMostHeight) ++step;
  if (step > 1) picture = reduced(picture, step);
  std::uint8_t* webp = nullptr;
  const std::size_t size =
      WebPEncodeRGBA(picture.rgba.data(), static_cast<int>(picture.width), static_cast<int>(picture.height),
                     static_cast<int>(4 * picture.width), kQuality, &webp);
  std::string encoded(reinterpret_cast<const char*>(webp), size);
  WebPFree(webp);
  if (size == 0) return std::nullopt;
  return PagePicture{"image/webp", std::move(encoded)};
}

}  // namespace carousel::shading
