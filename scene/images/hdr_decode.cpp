#include "scene/images/hdr_decode.h"

#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <string_view>

#include <fmt/format.h>

#include "core/system/plain_text.h"

namespace carousel::scene {

namespace {

constexpr std::string_view kMagic = "#?";
constexpr std::string_view kFormat = "32-bit_rle_rgbe";
constexpr std::size_t kPixelBytes = 4;
constexpr std::uint32_t kLeastRunWidth = 8, kMostRunWidth = 0x7fff;  // of rows that may have run lengths a channel
constexpr std::size_t kLongestLine = 4096, kShownText = 40;
/// Of a stored exponent, which stands for a mantissa of 8 bits below the point.
constexpr int kExponentBias = 128 + 8;

using Pixel = std::array<std::uint8_t, kPixelBytes>;

/// Walks over the file.
class HdrReader {
 public:
  explicit HdrReader(std::span<const unsigned char> bytes) : bytes_(bytes) {}

  struct Header {
    std::uint32_t width = 0, height = 0;
    double exposure = 1;
  };
  Header header();
  /// Decodes the next row.
  void row(std::span<Pixel> out);
  void end() const {
    if (at_ != bytes_.size())
      fail(at_, fmt::format("expected the end of the file after the last row, found {} more bytes", left()));
  }

  std::size_t left() const { return bytes_.size() - at_; }
  std::size_t at() const { return at_; }
  [[noreturn]] static void fail(std::size_t at, const std::string& why) {
    throw std::runtime_error(fmt::format("broken at byte {}: {}", at, why));
  }

 private:
  std::string_view line();
  void variable(std::string_view text, std::size_t at, Header& header);
  void flat_row(std::span<Pixel> out);
  void channel(std::span<Pixel> out, std::size_t c);
  std::uint8_t byte() {
    if (at_ == bytes_.size()) fail(at_, "the data ends early");
    return bytes_[at_++];
  }

  std::span<const unsigned char> bytes_;
  std::size_t at_ = 0;
};

std::string header_text(std::string_view text) {
  return plain_text(std::string(text.substr(0, kShownText)));
}

std::string_view HdrReader::line() {
  const std::size_t begin = at_;
  while (byte() != '\n')
    if (at_ - begin > kLongestLine) fail(begin, "a line of the header does not end");
  return {reinterpret_cast<const char*>(bytes_.data()) + begin, at_ - 1 - begin};
}

void HdrReader::variable(std::string_view text, std::size_t at, Header& header) {
  const std::size_t equals = text.find('=');
  if (equals == text.npos) return;  // the command that made the picture
  const std::string_view name = text.substr(0, equals);
  std::string_view value = text.substr(equals + 1);
  while (!value.empty() && (value.front() == ' ' || value.front() == '\t')) value.remove_prefix(1);
  while (!value.empty() && (value.back() == ' ' || value.back() == '\r')) value.remove_suffix(1);
  if (name == "FORMAT" && value != kFormat)
    fail(at, fmt::format("expected FORMAT={}, found '{}'", kFormat, header_text(value)));
  if (name == "COLORCORR") fail(at, "its colours are corrected (COLORCORR); expected a picture without it");
  if (name != "EXPOSURE") return;
  double factor = 0;
  const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), factor);
  header.exposure *= factor;
  if (error != std::errc{} || end != value.data() + value.size() || !(factor > 0) || !(header.exposure > 1e-30) ||
      !(header.exposure < 1e30))
    fail(at, fmt::format("expected EXPOSURE with a positive number, found '{}'", header_text(value)));
}

HdrReader::Header HdrReader::header() {
  Header out;
  line();
  for (bool more = true; more;) {
    const std::size_t at = at_;
    const std::string_view text = line();
    more = !text.empty() && text != "\r";
    if (more) variable(text, at, out);
  }
  const std::size_t at = at_;
  const std::string_view size = line();
  const auto number = [&](std::string_view& text, std::string_view before, std::uint32_t& value) {
    if (!text.starts_with(before)) return false;
    const auto [end, error] = std::from_chars(text.data() + before.size(), text.data() + text.size(), value);
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    return error == std::errc{} && value > 0 && value <= kMostSide;
  };
  std::string_view rest = size;
  if (!number(rest, "-Y ", out.height) || !number(rest, " +X ", out.width) || !(rest.empty() || rest == "\r"))
    fail(at, fmt::format("expected the size as '-Y height +X width' (rows from the top left, 1 to {} each), found '{}'",
                         kMostSide, header_text(size)));
  return out;
}

/// Pixels one by one; the pixel (1, 1, 1, n) repeats the last one n times, and another such one n times 256, ...
void HdrReader::flat_row(std::span<Pixel> out) {
  unsigned shift = 0;
  for (std::size_t x = 0; x < out.size();) {
    const std::size_t at = at_;
    Pixel pixel;
    for (std::uint8_t& value : pixel) value = byte();
    if (pixel[0] != 1 || pixel[1] != 1 || pixel[2] != 1) {
      out[x++] = pixel;
      shift = 0;
      continue;
    }
    const std::size_t count = shift < 32 ? std::size_t{pixel[3]} << shift : out.size() + 1;
    if (x == 0) fail(at, "a run has no pixel to repeat");
    if (count > out.size() - x)
      fail(at, fmt::format("a run of {} pixels goes beyond the row, of which {} are left", count, out.size() - x));
    for (std::size_t i = 0; i < count; ++i, ++x) out[x] = out[x - 1];
    shift += 8;
  }
}

void HdrReader::channel(std::span<Pixel> out, std::size_t c) {
  for (std::size_t x = 0; x < out.size();) {
    const std::size_t at = at_;
    const std::uint8_t code = byte();
    const bool run = code > 128;
    const std::size_t count = run ? code - std::size_t{128} : code;
    if (count == 0) fail(at, "a run has length 0");
    if (count > out.size() - x)
      fail(at, fmt::format("a run of {} bytes goes beyond the row, of which {} are left", count, out.size() - x));
    std::uint8_t value = run ? byte() : std::uint8_t{0};
    for (std::size_t i = 0; i < count; ++i, ++x) out[x][c] = run ? value : byte();
  }
}

void HdrReader::row(std::span<Pixel> out) {
  const auto width = static_cast<std::uint32_t>(out.size());
  const bool may_run = width >= kLeastRunWidth && width <= kMostRunWidth && left() >= kPixelBytes;
  if (!may_run || bytes_[at_] != 2 || bytes_[at_ + 1] != 2 || (bytes_[at_ + 2] & 0x80) != 0) return flat_row(out);
  const std::uint32_t said = std::uint32_t{bytes_[at_ + 2]} << 8 | bytes_[at_ + 3];
  if (said != width) fail(at_, fmt::format("a row says that it has {} pixels; expected {}", said, width));
  at_ += kPixelBytes;
  for (std::size_t c = 0; c < kPixelBytes; ++c) channel(out, c);
}

Vec3 radiance(const Pixel& pixel, double scale) {
  if (pixel[3] == 0) return Vec3{0};
  const double unit = std::ldexp(scale, int{pixel[3]} - kExponentBias);
  return {static_cast<float>(pixel[0] * unit), static_cast<float>(pixel[1] * unit),
          static_cast<float>(pixel[2] * unit)};
}

}  // namespace

bool is_hdr(std::span<const unsigned char> encoded) {
  return encoded.size() >= kMagic.size() &&
         std::string_view(reinterpret_cast<const char*>(encoded.data()), kMagic.size()) == kMagic;
}

FloatImage decode_hdr(std::span<const unsigned char> encoded, MemoryBudget& memory) {
  HdrReader reader(encoded);
  const HdrReader::Header header = reader.header();
  const std::uint64_t pixels = std::uint64_t{header.width} * header.height;
  // The shortest row: a run in each channel for every 127 pixels, or a pixel that is repeated.
  if (reader.left() / kPixelBytes < header.height)
    HdrReader::fail(reader.at(), fmt::format("{} bytes are left; {} rows need more", reader.left(), header.height));
  MemoryBudget::Loan work;
  try {
    work = memory.lend(std::uint64_t{header.width} * kPixelBytes);
    memory.take(pixels * kFloatPixelBytes);
  } catch (const std::length_error& error) {
    throw std::length_error(fmt::format("of {} x {} pixels {}", header.width, header.height, error.what()));
  }
  FloatImage out{header.width, header.height, {}};
  out.pixels.reserve(pixels);
  std::vector<Pixel> row(header.width);
  for (std::uint32_t y = 0; y < header.height; ++y) {
    reader.row(row);
    for (const Pixel& pixel : row) out.pixels.push_back(radiance(pixel, 1 / header.exposure));
  }
  reader.end();
  return out;
}

}  // namespace carousel::scene
