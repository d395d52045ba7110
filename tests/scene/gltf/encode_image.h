#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

#include <png.h>
#include <turbojpeg.h>

namespace carousel::scene {

/// A PNG of eight bits a channel: grey, grey and alpha, RGB or RGBA by the number of channels.
inline std::vector<unsigned char> encode_png(int width, int height, int channels,
                                             const std::vector<unsigned char>& pixels) {
  constexpr png_uint_32 kFormats[] = {PNG_FORMAT_GRAY, PNG_FORMAT_GA, PNG_FORMAT_RGB, PNG_FORMAT_RGBA};
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  image.width = static_cast<png_uint_32>(width);
  image.height = static_cast<png_uint_32>(height);
  image.format = kFormats[channels - 1];
  png_alloc_size_t size = PNG_IMAGE_PNG_SIZE_MAX(image);
  std::vector<unsigned char> bytes(size);
  if (png_image_write_to_memory(&image, bytes.data(), &size, 0, pixels.data(), 0, nullptr) == 0)
    throw std::runtime_error(image.message);
  bytes.resize(size);
  return bytes;
}

/// A JPEG of an RGB picture, or of four inks that are stored as they are.
inline std::vector<unsigned char> encode_jpeg(int width, int height, const std::vector<unsigned char>& pixels,
                                              TJPF format = TJPF_RGB) {
  tjhandle encoder = tjInitCompress();
  unsigned char* out = nullptr;
  unsigned long size = 0;
  const int failed = tjCompress2(encoder, pixels.data(), width, 0, height, format, &out, &size, TJSAMP_444, 95, 0);
  std::vector<unsigned char> bytes(out, out + size);
  tjFree(out);
  tjDestroy(encoder);
  if (failed != 0) throw std::runtime_error("JPEG");
  return bytes;
}

}  // namespace carousel::scene
