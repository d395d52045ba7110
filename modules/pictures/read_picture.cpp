#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <vector>

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>

#include "core/numeric/exponential.h"
#include "modules/pictures/picture_file.h"

namespace carousel::pictures {

namespace {

using scene::PictureAnswer;
using scene::PictureQuestion;

constexpr int kMostChannels = 64;

std::string without_newlines(std::string text) {
  std::replace(text.begin(), text.end(), '\n', ' ');
  while (!text.empty() && text.back() == ' ') text.pop_back();
  return text;
}

/// The format that OpenImageIO has for the ending of a file; empty if none.
std::string format_of_ending(const std::string& name) {
  const std::size_t dot = name.rfind('.');
  if (dot == name.npos) return "";
  std::string ending = name.substr(dot + 1);
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  // "tiff:tif,tiff;targa:tga,tpic"
  const std::string list = OIIO::get_string_attribute("extension_list");
  for (std::size_t at = 0; at < list.size();) {
    const std::size_t end = std::min(list.find(';', at), list.size()), colon = std::min(list.find(':', at), end);
    const std::string endings = "," + list.substr(colon + 1, end - colon - 1) + ",";
    if (endings.find("," + ending + ",") != endings.npos) return list.substr(at, colon - at);
    at = end + 1;
  }
  return "";
}

/// A picture that is open: its bytes, and a file of them for the formats that read nothing else.
struct Opened {
  std::unique_ptr<OIIO::Filesystem::IOMemReader> bytes;
  std::unique_ptr<MemoryFile> file;
  std::unique_ptr<OIIO::ImageInput> input;  // closed before the others
  OIIO::ImageSpec spec;
};

/// Some readers choose by the ending of the name, which then has to be one of the format.
std::string ending_of(const std::string& format, std::string_view bytes) {
  if (format == "jpeg2000") return bytes.starts_with("\xff\x4f") ? ".j2k" : ".jp2";
  return "." + format;
}

/// By the format that the first bytes tell, or else by that of the ending. Photographs of cameras begin as TIFF does.
Opened open(std::string_view bytes, const std::string& format, const std::string& name) {
  OIIO::ImageSpec wish;
  wish["oiio:UnassociatedAlpha"] = 1;  // colours as the file has them, not multiplied by alpha
  std::string why;
  for (const std::string& each : {format, format_of_ending(name)}) {
    if (each.empty() || each == "null" || each == "term") continue;
    Opened out;
    out.input = OIIO::ImageInput::create(each);
    if (!out.input) {
      why = "this OpenImageIO was built without the format " + each;
      OIIO::geterror();
      continue;
    }
    std::string file = "picture" + ending_of(each, bytes);
    if (out.input->supports("ioproxy")) {
      out.bytes = std::make_unique<OIIO::Filesystem::IOMemReader>(const_cast<char*>(bytes.data()), bytes.size());
      out.input->set_ioproxy(out.bytes.get());
    } else {
      out.file = std::make_unique<MemoryFile>(bytes);
      file = out.file->name();
    }
    if (out.input->open(file, out.spec, wish)) return out;
    if (why.empty()) why = "broken: " + without_newlines(out.input->geterror());
  }
  throw std::runtime_error(why);
}

/// Where red, green, blue and alpha stand among the channels.
struct Channels {
  int red = 0, green = 0, blue = 0, alpha = -1;
};

Channels channels_of(const OIIO::ImageSpec& spec) {
  Channels out;
  if (spec.alpha_channel >= 0 && spec.alpha_channel < spec.nchannels) out.alpha = spec.alpha_channel;
  if (spec.nchannels >= 3) out = {0, 1, 2, out.alpha};
  // Not spec.channelindex(), which ends the process where a reader names none.
  const auto find = [&](const char* name, int& channel) {
    const auto at = std::find(spec.channelnames.begin(), spec.channelnames.end(), name);
    if (at != spec.channelnames.end() && at - spec.channelnames.begin() < spec.nchannels)
      channel = static_cast<int>(at - spec.channelnames.begin());
  };
  find("R", out.red);
  find("G", out.green);
  find("B", out.blue);
  return out;
}

/// What the values of a picture of floats mean as light.
enum class Curve { kSrgb, kLinear, kPower };

float to_linear(float value, Curve curve, float gamma) {
  if (curve == Curve::kPower) return static_cast<float>(pow_precise(double{std::max(value, 0.0f)}, double{gamma}));
  return value;
}

float to_srgb(float c) {
  return c <= 0.0031308f ? 12.92f * c : 1.055f * pow_float(c, 1.0f / 2.4f) - 0.055f;  // IEC 61966-2-1
}

bool equal_words(std::string_view one, std::string_view other) {
  return one.size() == other.size() && std::equal(one.begin(), one.end(), other.begin(), [](char a, char b) {
           return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
         });
}

/// The pixels of a row as Image::rgba has them.
class Rows {
 public:
  Rows(const OIIO::ImageSpec& spec, bool color, std::string_view format)
      : channels_(channels_of(spec)), count_(spec.nchannels) {
    // Other readers, that of DDS for one, give colours as they are stored, without a word.
    constexpr std::string_view kMultiplied[] = {"openexr", "tiff", "rla", "targa", "psd"};
    multiplied_ = channels_.alpha >= 0 && spec.get_int_attribute("oiio:UnassociatedAlpha", 0) == 0 &&
                  std::ranges::find(kMultiplied, format) != std::end(kMultiplied);
    if (!color) return;
    const std::string space = spec.get_string_attribute("oiio:ColorSpace");
    const bool floats = spec.format.is_floating_point();
    if (equal_words(space, "linear") || equal_words(space, "lin_srgb") || equal_words(space, "scene_linear") ||
        (space.empty() && floats) || (format == "pnm" && floats))  // PFM: OpenImageIO calls it Rec709, as all of PNM
      curve_ = Curve::kLinear;
    if (space.starts_with("Gamma")) {
      curve_ = Curve::kPower;
      gamma_ = std::strtof(space.c_str() + 5, nullptr);
      if (!(gamma_ >= 0.1f && gamma_ <= 10)) curve_ = Curve::kSrgb;
    }
  }

  /// Nothing but the bits is changed.
  bool plain() const { return curve_ == Curve::kSrgb && !multiplied_; }

  void convert(const std::uint8_t* from, std::size_t width, std::uint8_t* to) const {
    each(
        from, width, to, [](std::uint8_t v) { return v; }, [](std::uint8_t v) { return v / 255.0f; });
  }
  void convert(const std::uint16_t* from, std::size_t width, std::uint8_t* to) const {
    // Rounded to the nearest, as libpng does (png_set_scale_16).
    each(
        from, width, to, [](std::uint16_t v) { return static_cast<std::uint8_t>((v * 255u + 32895u) >> 16); },
        [](std::uint16_t v) { return v / 65535.0f; });
  }
  void convert(const float* from, std::size_t width, std::uint8_t* to) const {
    each(
        from, width, to, [](float v) { return rounded(v); }, [](float v) { return v; });
  }

 private:
  static std::uint8_t rounded(float value) {
    return value > 0 ? static_cast<std::uint8_t>(std::min(value, 1.0f) * 255.0f + 0.5f) : std::uint8_t{0};
  }

  template <class T, class Plain, class Real>
  void each(const T* from, std::size_t width, std::uint8_t* to, const Plain& plain_value, const Real& real) const {
    for (std::size_t x = 0; x < width; ++x, from += count_, to += 4) {
      const T color[3] = {from[channels_.red], from[channels_.green], from[channels_.blue]};
      const bool has_alpha = channels_.alpha >= 0;
      to[3] = has_alpha ? plain_value(from[channels_.alpha]) : std::uint8_t{255};
      const float alpha = has_alpha ? real(from[channels_.alpha]) : 1.0f;
      for (int c = 0; c < 3; ++c) {
        if (plain()) {
          to[c] = plain_value(color[c]);
          continue;
        }
        float value = real(color[c]);
        if (multiplied_ && alpha > 0) value /= alpha;
        if (curve_ != Curve::kSrgb) value = to_srgb(std::clamp(to_linear(value, curve_, gamma_), 0.0f, 1.0f));
        to[c] = rounded(value);
      }
    }
  }

  Channels channels_;
  int count_;
  bool multiplied_ = false;
  Curve curve_ = Curve::kSrgb;
  float gamma_ = 1;
};

template <class T>
void read_rows(OIIO::ImageInput& input, const OIIO::ImageSpec& spec, OIIO::TypeDesc type, const Rows& rows,
               std::string& out) {
  const std::size_t width = static_cast<std::size_t>(spec.width), height = static_cast<std::size_t>(spec.height);
  std::vector<T> values(width * height * static_cast<std::size_t>(spec.nchannels));
  if (!input.read_image(0, 0, 0, spec.nchannels, type, values.data()))
    throw std::runtime_error("broken: " + without_newlines(input.geterror()));
  for (std::size_t y = 0; y < height; ++y)
    rows.convert(values.data() + y * width * static_cast<std::size_t>(spec.nchannels), width,
                 reinterpret_cast<std::uint8_t*>(out.data()) + y * width * 4);
}

std::string with_answer(std::string pixels, const PictureAnswer& answer) {
  pixels.append(reinterpret_cast<const char*>(&answer), sizeof answer);
  return pixels;
}

}  // namespace

std::string read_picture(std::string_view text) {
  PictureQuestion question;
  if (text.size() < sizeof question) throw std::runtime_error("broken: no question");
  std::memcpy(&question, text.data(), sizeof question);
  text.remove_prefix(sizeof question);
  if (text.size() < std::uint64_t{question.format_bytes} + question.name_bytes)
    throw std::runtime_error("broken: no question");
  const std::string format(text.substr(0, question.format_bytes));
  const std::string name(text.substr(question.format_bytes, question.name_bytes));
  OIIO::attribute("threads", 1);
  OIIO::attribute("exr_threads", 1);

  const Opened opened = open(text.substr(std::size_t{question.format_bytes} + question.name_bytes), format, name);
  const OIIO::ImageSpec& spec = opened.spec;
  if (spec.deep) throw std::runtime_error("of deep pixels, which no texture has");
  if (spec.width <= 0 || spec.height <= 0 || spec.nchannels <= 0 || spec.nchannels > kMostChannels)
    throw std::runtime_error("broken: it has no pixels");
  if (spec.depth > 1) throw std::runtime_error("of several layers in depth, which no texture has");
  const bool bytes = spec.format == OIIO::TypeDesc::UINT8, shorts = spec.format == OIIO::TypeDesc::UINT16;
  const std::uint64_t pixels = static_cast<std::uint64_t>(spec.width) * static_cast<std::uint64_t>(spec.height);
  PictureAnswer answer{static_cast<std::uint32_t>(spec.width), static_cast<std::uint32_t>(spec.height), 0};
  answer.work = pixels * static_cast<std::uint64_t>(spec.nchannels) * (bytes ? 1u : shorts ? 2u : 4u);
  if (answer.work + 4 * pixels > question.memory) return with_answer({}, answer);

  std::string out(static_cast<std::size_t>(pixels * 4), '\0');
  const Rows rows(spec, question.color, opened.input->format_name());
  if (bytes)
    read_rows<std::uint8_t>(*opened.input, spec, OIIO::TypeDesc::UINT8, rows, out);
  else if (shorts)
    read_rows<std::uint16_t>(*opened.input, spec, OIIO::TypeDesc::UINT16, rows, out);
  else
    read_rows<float>(*opened.input, spec, OIIO::TypeDesc::FLOAT, rows, out);
  return with_answer(std::move(out), answer);
}

}  // namespace carousel::pictures
