#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <vector>

#include <ImfChannelList.h>
#include <ImfCompression.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>

namespace carousel {

struct ExrPicture {
  int width = 0, height = 0;
  bool zip = false;
  std::vector<float> rgb;  // row-major from the top left
};

/// The picture of an EXR file. Throws what OpenEXR throws.
inline ExrPicture read_exr(const std::filesystem::path& path) {
  Imf::InputFile file(path.c_str());
  const auto window = file.header().dataWindow();
  ExrPicture out;
  out.width = window.max.x - window.min.x + 1;
  out.height = window.max.y - window.min.y + 1;
  out.zip = file.header().compression() == Imf::ZIP_COMPRESSION;
  out.rgb.resize(std::size_t{3} * static_cast<std::size_t>(out.width) * static_cast<std::size_t>(out.height), -1);
  constexpr std::size_t kPixel = 3 * sizeof(float);
  Imf::FrameBuffer channels;
  float* first = out.rgb.data();
  for (const char* name : {"R", "G", "B"})
    channels.insert(name, Imf::Slice(Imf::FLOAT, reinterpret_cast<char*>(first++), kPixel,
                                     kPixel * static_cast<std::size_t>(out.width)));
  file.setFrameBuffer(channels);
  file.readPixels(window.min.y, window.max.y);
  return out;
}

}  // namespace carousel
