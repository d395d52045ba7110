#include "scene/images/image_decode.h"

#include <array>
#include <cstring>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include "scene/images/png_check.h"
#include "scene/images/webp_decode.h"

namespace carousel::scene {

namespace {

constexpr std::uint64_t kMostPixels = std::uint64_t{1} << 26;
/// Deflate packs at most 1032:1, and a PNG byte holds at most 8 pixels; JPEG and pictures worth a WebP stay far below.
constexpr std::uint64_t kMostPixelsPerByte = 8 * 1032;

const char* format_of(std::span<const unsigned char> bytes) {
  constexpr std::array<unsigned char, 8> kPng = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
  constexpr std::array<unsigned char, 3> kJpeg = {0xff, 0xd8, 0xff};
  if (bytes.size() > kPng.size() && std::memcmp(bytes.data(), kPng.data(), kPng.size()) == 0) return "png";
  if (bytes.size() > kJpeg.size() && std::memcmp(bytes.data(), kJpeg.data(), kJpeg.size()) == 0) return "jpeg";
  if (bytes.size() > 12 && std::memcmp(bytes.data(), "RIFF", 4) == 0 && std::memcmp(bytes.data() + 8, "WEBP", 4) == 0)
    return "webp";
  return nullptr;
}

/// Before anything is allocated.
void check_size(std::uint64_t width, std::uint64_t height, std::size_t bytes) {
  const std::string size = std::to_string(width) + " x " + std::to_string(height);
  if (width * height > kMostPixels) throw std::runtime_error(size + " pixels; at most 67108864 in all are read");
  if (width * height > kMostPixelsPerByte * bytes) {
    throw std::runtime_error(size + " pixels announced in only " + std::to_string(bytes) + " bytes");
  }
}

}  // namespace

Image decode_image(std::span<const unsigned char> encoded) {
  const char* format = format_of(encoded);
  if (format == nullptr) throw std::runtime_error("neither PNG nor JPEG nor WebP");
  if (std::string_view(format) == "webp") {
    const WebpHeader header = read_webp_header(encoded);
    check_size(header.width, header.height, encoded.size());
    return decode_webp(encoded, header);
  }

  if (std::string_view(format) == "png") {
    if (const char* fault = png_fault(encoded)) throw std::runtime_error(std::string("broken: ") + fault);
  }

  OIIO::Filesystem::IOMemReader reader(encoded.data(), encoded.size());
  OIIO::ImageSpec config;
  config.attribute("oiio:UnassociatedAlpha", 1);  // glTF's alpha is coverage beside colour, not premultiplied
  // Not ImageInput::open(name, config, proxy): seen with OpenImageIO 2.4, it opens a file of that name
  // instead.
  auto input = OIIO::ImageInput::create(format);
  if (!input) throw std::runtime_error("a format this OpenImageIO does not read: " + OIIO::geterror());
  OIIO::ImageSpec spec;
  if (!input->set_ioproxy(&reader) || !input->open("", spec, config)) {
    throw std::runtime_error("broken: " + input->geterror());
  }
  const auto pixels = static_cast<std::uint64_t>(spec.width) * static_cast<std::uint64_t>(spec.height);
  if (spec.width <= 0 || spec.height <= 0 || spec.nchannels <= 0 || spec.nchannels > 4) {
    throw std::runtime_error("of an unusable size or channel count");
  }
  check_size(static_cast<std::uint64_t>(spec.width), static_cast<std::uint64_t>(spec.height), encoded.size());

  const auto channels = static_cast<std::size_t>(spec.nchannels);
  std::vector<std::uint8_t> raw(static_cast<std::size_t>(pixels) * channels);
  if (!input->read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::UINT8, raw.data())) {
    const std::string reason = input->geterror();
    throw std::runtime_error("broken: " + (reason.empty() ? std::string("the data ends early") : reason));
  }

  Image image;
  image.width = static_cast<std::uint32_t>(spec.width);
  image.height = static_cast<std::uint32_t>(spec.height);
  image.rgba.resize(static_cast<std::size_t>(pixels) * 4);
  for (std::size_t i = 0; i < pixels; ++i) {
    const std::uint8_t* from = &raw[i * channels];
    std::uint8_t* to = &image.rgba[i * 4];
    const bool grey = channels < 3;
    to[0] = from[0];
    to[1] = grey ? from[0] : from[1];
    to[2] = grey ? from[0] : from[2];
    to[3] = channels == 2 ? from[1] : channels == 4 ? from[3] : std::uint8_t{255};
  }
  return image;
}

}  // namespace carousel::scene
