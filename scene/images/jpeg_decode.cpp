#include "scene/images/jpeg_decode.h"

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include <turbojpeg.h>

namespace carousel::scene {

namespace {

using Decoder = std::unique_ptr<void, decltype(&tjDestroy)>;

Decoder make_decoder() {
  Decoder out(tjInitDecompress(), &tjDestroy);
  if (!out) throw std::runtime_error("libjpeg-turbo cannot be started");
  return out;
}

[[noreturn]] void refuse(const Decoder& decoder) {
  throw std::runtime_error(std::string("broken: ") + tjGetErrorStr2(decoder.get()));
}

struct Header {
  int width = 0, height = 0, subsampling = 0, colors = 0;
};

Header read_header(const Decoder& decoder, std::span<const unsigned char> encoded) {
  Header out;
  if (tjDecompressHeader3(decoder.get(), encoded.data(), encoded.size(), &out.width, &out.height, &out.subsampling,
                          &out.colors) != 0)
    refuse(decoder);
  return out;
}

}  // namespace

JpegHeader read_jpeg_header(std::span<const unsigned char> encoded) {
  const Header header = read_header(make_decoder(), encoded);
  return {static_cast<std::uint32_t>(header.width), static_cast<std::uint32_t>(header.height)};
}

Image decode_jpeg(std::span<const unsigned char> encoded, const JpegHeader& size) {
  const Decoder decoder = make_decoder();
  const Header header = read_header(decoder, encoded);
  const bool inks = header.colors == TJCS_CMYK || header.colors == TJCS_YCCK;
  Image image;
  image.width = size.width;
  image.height = size.height;
  image.rgba.resize(std::size_t{4} * size.width * size.height);
  // A warning, such as data that end early, leaves grey where pixels are missing, as browsers do.
  if (tjDecompress2(decoder.get(), encoded.data(), encoded.size(), image.rgba.data(), header.width, 0, header.height,
                    inks ? TJPF_CMYK : TJPF_RGBA, 0) != 0 &&
      tjGetErrorCode(decoder.get()) == TJERR_FATAL)
    refuse(decoder);
  if (!inks) return image;
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
    const unsigned black = image.rgba[i + 3];
    for (std::size_t c = 0; c < 3; ++c)
      image.rgba[i + c] = static_cast<std::uint8_t>((image.rgba[i + c] * black + 127) / 255);
    image.rgba[i + 3] = 255;
  }
  return image;
}

}  // namespace carousel::scene
