#include "scene/images/exr_decode.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <exception>
#include <new>
#include <stdexcept>
#include <string>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfVersion.h>
#include <fmt/format.h>

#include "core/system/plain_text.h"

namespace carousel::scene {

namespace {

/// Bytes that OpenEXR keeps for each pixel beside the picture while it reads one, at most: a tiled picture as a whole.
constexpr std::uint64_t kExrWorkPerPixel = 16;

/// Lets OpenEXR read the bytes, and keeps the place at which it reads for the message of a fault.
class MemoryStream : public Imf::IStream {
 public:
  explicit MemoryStream(std::span<const unsigned char> bytes) : IStream("the file"), bytes_(bytes) {}
  bool read(char out[], int count) override {
    const auto size = static_cast<std::size_t>(count);
    if (at_ > bytes_.size() || size > bytes_.size() - at_) throw std::runtime_error("the data ends early");
    std::memcpy(out, bytes_.data() + at_, size);
    at_ += size;
    return at_ < bytes_.size();
  }
  std::uint64_t tellg() override { return at_; }
  void seekg(std::uint64_t at) override { at_ = at; }

 private:
  std::span<const unsigned char> bytes_;
  std::uint64_t at_ = 0;
};

struct Window {
  std::int64_t x = 0, y = 0, width = 0, height = 0;
};

Window window_of(const Imf::Header& header) {
  const auto& box = header.dataWindow();
  return {box.min.x, box.min.y, std::int64_t{box.max.x} - box.min.x + 1, std::int64_t{box.max.y} - box.min.y + 1};
}

void read_channels(Imf::InputFile& file, const Window& window, FloatImage& out) {
  const Imf::ChannelList& channels = file.header().channels();
  const bool colored = channels.findChannel("R") && channels.findChannel("G") && channels.findChannel("B");
  if (!colored && !channels.findChannel("Y")) throw std::runtime_error("has no channels R, G and B, nor Y");
  constexpr std::size_t kPixel = sizeof(Vec3);
  Imf::FrameBuffer buffer;
  for (std::size_t c = 0; c < (colored ? 3u : 1u); ++c) {
    auto* first = reinterpret_cast<char*>(out.pixels.data()) + c * sizeof(float);
    buffer.insert(std::string(1, (colored ? "RGB" : "Y")[c]),
                  Imf::Slice::Make(Imf::FLOAT, first, file.header().dataWindow(), kPixel,
                                   kPixel * static_cast<std::size_t>(window.width)));
  }
  file.setFrameBuffer(buffer);
  file.readPixels(static_cast<int>(window.y), static_cast<int>(window.y + window.height - 1));
  if (!colored)
    for (Vec3& pixel : out.pixels) pixel = Vec3{pixel.x};
}

}  // namespace

bool is_exr(std::span<const unsigned char> encoded) {
  return encoded.size() >= 4 && Imf::isImfMagic(reinterpret_cast<const char*>(encoded.data()));
}

FloatImage decode_exr(std::span<const unsigned char> encoded, MemoryBudget& memory) {
  MemoryStream stream(encoded);
  MemoryBudget::Loan work;
  try {
    Imf::InputFile file(stream, 0);
    const Window window = window_of(file.header());
    if (window.width < 1 || window.height < 1 || window.width > kMostSide || window.height > kMostSide)
      throw std::runtime_error(
          fmt::format("has {} x {} pixels; expected 1 to {} each", window.width, window.height, kMostSide));
    const std::uint64_t pixels = static_cast<std::uint64_t>(window.width) * static_cast<std::uint64_t>(window.height);
    try {
      work = memory.lend(pixels * kExrWorkPerPixel);
      memory.take(pixels * kFloatPixelBytes);
    } catch (const std::length_error& error) {
      throw std::length_error(fmt::format("of {} x {} pixels {}", window.width, window.height, error.what()));
    }
    FloatImage out{static_cast<std::uint32_t>(window.width), static_cast<std::uint32_t>(window.height), {}};
    out.pixels.resize(pixels);
    read_channels(file, window, out);
    return out;
  } catch (const std::length_error&) {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const std::exception& fault) {  // those of OpenEXR are others at each version
    throw std::runtime_error(fmt::format("broken, read up to byte {}: {}", stream.tellg(), plain_text(fault.what())));
  }
}

}  // namespace carousel::scene
