#include "scene/images/picture_format.h"

#include <algorithm>
#include <array>
#include <cstddef>

namespace carousel::scene {

namespace {

using namespace std::string_view_literals;

/// Bytes that tell a format, and where they stand; counted from the end if negative.
struct Signature {
  PictureFormat format;
  std::ptrdiff_t at;
  std::string_view bytes;
};

constexpr PictureFormat kTiff{"tiff", "TIFF"}, kJpeg2000{"jpeg2000", "JPEG 2000"}, kTga{"targa", "TGA"},
    kDpx{"dpx", "DPX"}, kPnm{"pnm", "PNM"}, kHdr{"hdr", "Radiance HDR"}, kIff{"iff", "IFF"}, kZfile{"zfile", "Zfile"},
    kHeif{"heif", "HEIF"};

// Longer ones first, where one begins another.
constexpr std::array kSignatures{
    Signature{kTiff, 0, "II*\0"sv},
    Signature{kTiff, 0, "MM\0*"sv},
    Signature{kTiff, 0, "II+\0"sv},
    Signature{kTiff, 0, "MM\0+"sv},
    Signature{{"dds", "DDS"}, 0, "DDS "sv},
    Signature{kHdr, 0, "#?RADIANCE"sv},
    Signature{kHdr, 0, "#?RGBE"sv},
    Signature{{"psd", "PSD"}, 0, "8BPS"sv},
    Signature{kJpeg2000, 0, "\0\0\0\x0cjP  "sv},
    Signature{kJpeg2000, 0, "\xff\x4f\xff\x51"sv},
    Signature{{"openexr", "EXR"}, 0, "\x76\x2f\x31\x01"sv},
    Signature{{"gif", "GIF"}, 0, "GIF8"sv},
    Signature{kDpx, 0, "SDPX"sv},
    Signature{kDpx, 0, "XPDS"sv},
    Signature{{"cineon", "Cineon"}, 0, "\x80\x2a\x5f\xd7"sv},
    Signature{kIff, 0, "FOR4"sv},
    Signature{kIff, 0, "FORM"sv},
    Signature{{"fits", "FITS"}, 0, "SIMPLE  ="sv},
    Signature{{"softimage", "Softimage PIC"}, 0, "\x53\x80\xf6\x34"sv},
    Signature{kZfile, 0, "\x2f\x08\x67\xab"sv},
    Signature{kZfile, 0, "\xab\x67\x08\x2f"sv},
    Signature{{"ico", "ICO"}, 0, "\0\0\1\0"sv},
    Signature{kHeif, 4, "ftyphei"sv},
    Signature{kHeif, 4, "ftypavif"sv},
    Signature{kHeif, 4, "ftypmif1"sv},
    Signature{{"dicom", "DICOM"}, 128, "DICM"sv},
    Signature{kTga, -18, "TRUEVISION-XFILE.\0"sv},
    Signature{{"sgi", "SGI"}, 0, "\x01\xda"sv},
    Signature{{"bmp", "BMP"}, 0, "BM"sv},
    Signature{kPnm, 0, "P1\n"sv},
    Signature{kPnm, 0, "P2\n"sv},
    Signature{kPnm, 0, "P3\n"sv},
    Signature{kPnm, 0, "P4\n"sv},
    Signature{kPnm, 0, "P5\n"sv},
    Signature{kPnm, 0, "P6\n"sv},
    Signature{kPnm, 0, "PF\n"sv},
    Signature{kPnm, 0, "Pf\n"sv},
};

/// Formats without such bytes, or that write them in several ways.
struct Ending {
  std::string_view ending;
  PictureFormat format;
};
constexpr std::array kEndings{
    Ending{".tga", kTga},
    Ending{".tpic", kTga},
    Ending{".targa", kTga},
    Ending{".rla", {"rla", "RLA"}},
    Ending{".ppm", kPnm},
    Ending{".pgm", kPnm},
    Ending{".pbm", kPnm},
    Ending{".pnm", kPnm},
    Ending{".pfm", kPnm},
    Ending{".hdr", kHdr},
    Ending{".pic", {"softimage", "Softimage PIC"}},
    Ending{".dng", {"raw", "camera raw"}},
    Ending{".cr2", {"raw", "camera raw"}},
    Ending{".cr3", {"raw", "camera raw"}},
    Ending{".nef", {"raw", "camera raw"}},
    Ending{".arw", {"raw", "camera raw"}},
    Ending{".raf", {"raw", "camera raw"}},
    Ending{".orf", {"raw", "camera raw"}},
    Ending{".rw2", {"raw", "camera raw"}},
};

bool has(std::string_view bytes, const Signature& signature) {
  const auto size = static_cast<std::ptrdiff_t>(bytes.size());
  const std::ptrdiff_t at = signature.at < 0 ? size + signature.at : signature.at;
  return at >= 0 && at <= size && bytes.substr(static_cast<std::size_t>(at)).starts_with(signature.bytes);
}

bool ends_with(std::string_view name, std::string_view ending) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; };
  return name.size() > ending.size() &&
         std::equal(ending.rbegin(), ending.rend(), name.rbegin(), [&](char e, char n) { return e == lower(n); });
}

}  // namespace

PictureFormat picture_format(std::span<const unsigned char> bytes, std::string_view name) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  for (const Ending& each : kEndings)
    if (each.format.name == "raw" && ends_with(name, each.ending)) return each.format;  // most of them begin as TIFF
  for (const Signature& each : kSignatures)
    if (has(text, each)) return each.format;
  for (const Ending& each : kEndings)
    if (ends_with(name, each.ending)) return each.format;
  return {};
}

}  // namespace carousel::scene
