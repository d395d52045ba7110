#include "scene/images/webp_decode.h"

#include <stdexcept>

#include <webp/decode.h>

namespace carousel::scene {

WebpHeader read_webp_header(std::span<const unsigned char> encoded) {
  WebPBitstreamFeatures features;
  if (WebPGetFeatures(encoded.data(), encoded.size(), &features) != VP8_STATUS_OK || features.width <= 0 ||
      features.height <= 0) {
    throw std::runtime_error("broken: no WebP header");
  }
  if (features.has_animation != 0) throw std::runtime_error("an animation");
  return {static_cast<std::uint32_t>(features.width), static_cast<std::uint32_t>(features.height)};
}

Image decode_webp(std::span<const unsigned char> encoded, const WebpHeader& header) {
  Image image;
  image.width = header.width;
  image.height = header.height;
  image.rgba.resize(std::size_t{4} * header.width * header.height);
  const auto stride = static_cast<int>(4 * header.width);  // WebP is at most 16383 wide
  if (WebPDecodeRGBAInto(encoded.data(), encoded.size(), image.rgba.data(), image.rgba.size(), stride) == nullptr) {
    throw std::runtime_error("broken: the data cannot be decoded");
  }
  return image;
}

}  // namespace carousel::scene
