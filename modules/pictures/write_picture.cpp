#include <algorithm>
#include <array>
#include <memory>
#include <span>
#include <stdexcept>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include "modules/pictures/picture_file.h"

namespace carousel::pictures {

namespace {

/// How a picture is written: for computation as floats, or for display with 8 bits.
struct Writing {
  std::string_view ending;
  const char* format;
  bool floats;
  const char* compression = "";
};
constexpr std::array kWritings{
    Writing{"tiff", "tiff", true, "zip"},  Writing{"hdr", "hdr", true},
    Writing{"fits", "fits", true},         Writing{"jpg", "jpeg", false, "jpeg:95"},
    Writing{"jp2", "jpeg2000", false},     Writing{"webp", "webp", false, "webp:95"},
    Writing{"tga", "targa", false, "rle"}, Writing{"bmp", "bmp", false},
    Writing{"gif", "gif", false},          Writing{"ppm", "pnm", false},
    Writing{"dpx", "dpx", false},          Writing{"sgi", "sgi", false},
    Writing{"rla", "rla", false},          Writing{"iff", "iff", false},
};

const Writing& writing_of(std::string_view ending) {
  const auto found =
      std::find_if(kWritings.begin(), kWritings.end(), [&](const Writing& w) { return w.ending == ending; });
  if (found == kWritings.end()) throw std::runtime_error("no format with this ending is written");
  return *found;
}

// OpenImageIO 2.4 reads PFM and writes none. Debevec's description: a line each for kind, size and byte order, then the
// rows from the bottom up.
constexpr std::string_view kPfm = "pfm";
std::string pfm(std::uint32_t width, std::uint32_t height, std::span<const float> linear) {
  std::string out = "PF\n" + std::to_string(width) + " " + std::to_string(height) + "\n-1.0\n";
  const std::size_t row = std::size_t{3} * width;
  for (std::size_t y = height; y-- > 0;)
    out.append(reinterpret_cast<const char*>(linear.data() + y * row), row * sizeof(float));
  return out;
}

}  // namespace

bool writes_picture(const std::string& ending) {
  if (ending == kPfm) return true;
  const bool there = OIIO::ImageOutput::create(writing_of(ending).format) != nullptr;
  OIIO::geterror();
  return there;
}

std::string write_picture(const std::string& ending, std::uint32_t width, std::uint32_t height,
                          std::span<const float> linear, std::span<const std::uint8_t> display) {
  if (ending == kPfm) return pfm(width, height, linear);
  const Writing& writing = writing_of(ending);
  // OpenImageIO 2.4 asks for six resolutions, each half the one before, and writes a smaller picture so that none reads
  // it.
  if (ending == "jp2" && std::min(width, height) < 32)
    throw std::runtime_error("JPEG 2000 is written for 32 pixels at least in width and height");
  const auto output = OIIO::ImageOutput::create(writing.format);
  if (!output) throw std::runtime_error(OIIO::geterror());
  OIIO::ImageSpec spec(static_cast<int>(width), static_cast<int>(height), 3,
                       writing.floats ? OIIO::TypeDesc::FLOAT : OIIO::TypeDesc::UINT8);
  spec.attribute("oiio:ColorSpace", writing.floats ? "Linear" : "sRGB");
  spec.attribute("Software", "carousel");
  if (*writing.compression != '\0') spec.attribute("compression", writing.compression);
  const void* pixels = writing.floats ? static_cast<const void*>(linear.data()) : display.data();
  // Into memory, from where the caller writes the whole file or nothing; some formats want a file for it.
  OIIO::Filesystem::IOVecOutput memory;
  std::unique_ptr<MemoryFile> file;
  std::string name = "image." + ending;
  if (output->supports("ioproxy")) {
    output->set_ioproxy(&memory);
  } else {
    file = std::make_unique<MemoryFile>();
    name = file->name();
  }
  if (!output->open(name, spec) || !output->write_image(spec.format, pixels) || !output->close())
    throw std::runtime_error(output->geterror());
  if (file) return file->bytes();
  return {memory.buffer().begin(), memory.buffer().end()};
}

}  // namespace carousel::pictures
