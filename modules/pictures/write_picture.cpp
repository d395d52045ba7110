#include <algorithm>
#include <array>
#include <span>
#include <stdexcept>

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
    Writing{"tiff", "tiff", true, "zip"},
    Writing{"hdr", "hdr", true},
    Writing{"pfm", "pnm", true},
    Writing{"fits", "fits", true},
    Writing{"jpg", "jpeg", false, "jpeg:95"},
    Writing{"jp2", "jpeg2000", false},
    Writing{"webp", "webp", false, "lossless"},
    Writing{"tga", "targa", false, "rle"},
    Writing{"bmp", "bmp", false},
    Writing{"gif", "gif", false},
    Writing{"ppm", "pnm", false},
    Writing{"dpx", "dpx", false},
    Writing{"sgi", "sgi", false},
    Writing{"rla", "rla", false},
    Writing{"iff", "iff", false},
};

const Writing& writing_of(std::string_view ending) {
  const auto found =
      std::find_if(kWritings.begin(), kWritings.end(), [&](const Writing& w) { return w.ending == ending; });
  if (found == kWritings.end()) throw std::runtime_error("no format with this ending is written");
  return *found;
}

}  // namespace

bool writes_picture(const std::string& ending) {
  const bool there = OIIO::ImageOutput::create(writing_of(ending).format) != nullptr;
  OIIO::geterror();
  return there;
}

std::string write_picture(const std::string& ending, std::uint32_t width, std::uint32_t height,
                          std::span<const float> linear, std::span<const std::uint8_t> display) {
  const Writing& writing = writing_of(ending);
  const auto output = OIIO::ImageOutput::create(writing.format);
  if (!output) throw std::runtime_error(OIIO::geterror());
  const MemoryFile file;
  OIIO::ImageSpec spec(static_cast<int>(width), static_cast<int>(height), 3,
                       writing.floats ? OIIO::TypeDesc::FLOAT : OIIO::TypeDesc::UINT8);
  spec.attribute("oiio:ColorSpace", writing.floats ? "Linear" : "sRGB");
  spec.attribute("Software", "carousel");
  if (*writing.compression != '\0') spec.attribute("compression", writing.compression);
  // Its name has no ending: some formats choose by it.
  if (ending == "pfm") spec.attribute("pnm:binary", 1);
  const void* pixels = writing.floats ? static_cast<const void*>(linear.data()) : display.data();
  if (!output->open(file.name(), spec) || !output->write_image(spec.format, pixels) || !output->close())
    throw std::runtime_error(output->geterror());
  return file.bytes();
}

}  // namespace carousel::pictures
