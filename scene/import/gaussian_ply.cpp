#include "scene/import/gaussian_ply.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <map>
#include <new>
#include <optional>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include "core/numeric/exponential.h"
#include "core/system/error.h"
#include "core/system/memory_budget.h"
#include "core/system/plain_text.h"
#include "scene/model/fitted_camera.h"

namespace carousel::scene {

namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLongestHeader = std::size_t{1} << 16;
static_assert(std::endian::native == std::endian::little);

/// The properties that are read, in the order of a row.
constexpr auto kNames = std::to_array<const char*>({"x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2", "opacity", "scale_0",
                                                    "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"});
using Row = std::array<float, kNames.size()>;
constexpr std::string_view kHigher = "f_rest_";  // harmonics above degree 0: all of red, then of green, then of blue

const std::map<std::string, std::size_t>& bytes_of_types() {
  static const std::map<std::string, std::size_t> table{{"char", 1},  {"uchar", 1},   {"int8", 1},   {"uint8", 1},
                                                        {"short", 2}, {"ushort", 2},  {"int16", 2},  {"uint16", 2},
                                                        {"int", 4},   {"uint", 4},    {"int32", 4},  {"uint32", 4},
                                                        {"float", 4}, {"float32", 4}, {"double", 8}, {"float64", 8}};
  return table;
}

std::string beginning(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::string head(kLongestHeader, '\0');
  in.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(in.gcount()));
  return head;
}

/// What a header says of its Gaussians.
struct Layout {
  std::uint64_t count = 0, begin = 0, stride = 0;
  std::array<std::optional<std::uint64_t>, kNames.size()> at;  ///< bytes from the start of a Gaussian's data
  std::vector<std::optional<std::uint64_t>> higher;            ///< likewise of f_rest_*, by number
  int degree = 0;                                              ///< of harmonics, by the number of these
};

class HeaderReader {
 public:
  HeaderReader(const fs::path& file, const std::string& head) : file_(file), head_(head) {}

  Layout read() {
    bool format = false, vertices = false, ended = false;
    while (!ended) {
      const std::size_t end = head_.find('\n', out_.begin);
      if (end == head_.npos) fail("the header does not end: there is no end_header");
      ++number_;
      std::istringstream words(head_.substr(out_.begin, end - out_.begin));
      out_.begin = end + 1;
      std::string word, first, second;
      words >> word >> first >> second;
      if (word == "format") {
        if (first != "binary_little_endian") fail_at("expected format binary_little_endian 1.0, found " + shown(first));
        format = true;
      } else if (word == "element") {
        if (vertices || first != "vertex") fail_at("expected one element, vertex, found " + shown(first));
        vertices = true;
        read_count(second);
      } else if (word == "property") {
        if (!vertices) fail_at("expected element vertex before its properties");
        read_property(first, second);
      }
      ended = word == "end_header";
    }
    if (!format) fail("the header names no format; expected binary_little_endian 1.0");
    for (std::size_t i = 0; i < kNames.size(); ++i)
      if (!out_.at[i]) fail(std::string("the header has no property float ") + kNames[i]);
    read_degree();
    return out_;
  }

 private:
  [[noreturn]] void fail(const std::string& why) const { throw SceneError(file_.string(), "", why); }
  [[noreturn]] void fail_at(const std::string& why) const { fail("line " + std::to_string(number_) + ": " + why); }
  static std::string shown(const std::string& word) {
    constexpr std::size_t kLongest = 40;
    return '"' + plain_text(word).substr(0, kLongest) + '"';
  }

  void read_count(const std::string& text) {
    constexpr std::size_t kDigits = 18;
    if (text.empty() || text.size() > kDigits || text.find_first_not_of("0123456789") != text.npos)
      fail_at("expected a number of Gaussians, found " + shown(text));
    out_.count = std::stoull(text);
  }

  void read_property(const std::string& type, const std::string& name) {
    const auto bytes = bytes_of_types().find(type);
    if (bytes == bytes_of_types().end()) fail_at("expected a property of one number, found type " + shown(type));
    if (std::optional<std::uint64_t>* const at = place_of(name)) {
      if (type != "float" && type != "float32")
        fail_at("expected property float " + name + ", found type " + shown(type));
      if (*at) fail_at("the property " + name + " is there twice");
      *at = out_.stride;
    }
    out_.stride += bytes->second;
  }

  /// Null if the property is not read.
  std::optional<std::uint64_t>* place_of(const std::string& name) {
    if (const auto read = std::find(kNames.begin(), kNames.end(), name); read != kNames.end())
      return &out_.at[static_cast<std::size_t>(read - kNames.begin())];
    if (!name.starts_with(kHigher)) return nullptr;
    const std::string number = name.substr(kHigher.size());
    constexpr std::size_t kDigits = 2, kMost = 3 * higher_harmonics(kMostHarmonicDegree);
    if (number.empty() || number.size() > kDigits || number.find_first_not_of("0123456789") != number.npos ||
        std::stoul(number) >= kMost || (number.size() > 1 && number[0] == '0'))
      fail_at(fmt::format("expected f_rest_0 to f_rest_{}, found {}", kMost - 1, shown(name)));
    const std::size_t at = std::stoul(number);
    if (at >= out_.higher.size()) out_.higher.resize(at + 1);
    return &out_.higher[at];
  }

  void read_degree() {
    for (std::size_t i = 0; i < out_.higher.size(); ++i)
      if (!out_.higher[i])
        fail(
            fmt::format("the header has no property float f_rest_{}, and it has f_rest_{}", i, out_.higher.size() - 1));
    while (out_.degree < kMostHarmonicDegree && 3 * higher_harmonics(out_.degree) < out_.higher.size()) ++out_.degree;
    if (3 * higher_harmonics(out_.degree) != out_.higher.size())
      fail(
          fmt::format("the header has {} properties f_rest_*; expected 0, 9, 24 or 45, as harmonics of degree 0, 1, 2 "
                      "or 3 have",
                      out_.higher.size()));
  }

  const fs::path& file_;
  const std::string& head_;
  int number_ = 0;
  Layout out_;
};

/// Adds a Gaussian, or returns what is wrong with it.
std::optional<std::string> add(const Row& row, GaussianCloud& cloud) {
  for (std::size_t i = 0; i < row.size(); ++i)
    if (!std::isfinite(row[i])) return fmt::format("{} is {}; expected a finite number", kNames[i], row[i]);
  Gaussian& out = cloud.shapes.emplace_back();
  out.mean = {row[0], row[1], row[2]};
  out.color = color_of_harmonics({row[3], row[4], row[5]});
  out.opacity = static_cast<float>(1 / (1 + exp_precise(-double{row[6]})));
  const DVec3 deviations{exp_precise(double{row[7]}), exp_precise(double{row[8]}), exp_precise(double{row[9]})};
  const double rotation[4] = {row[11], row[12], row[13], row[10]};
  const std::optional<Mat3> spread = spread_of(rotation, deviations);
  if (!spread && row[10] == 0 && row[11] == 0 && row[12] == 0 && row[13] == 0)
    return "rot_0 to rot_3 are 0, which is no rotation";
  if (!spread)
    return fmt::format("scale_0 to scale_2 are {}, {}, {}; expected logarithms of lengths that single precision holds",
                       row[7], row[8], row[9]);
  out.spread = *spread;
  return std::nullopt;
}

/// Likewise the harmonics above degree 0 of one.
std::optional<std::string> add_harmonics(const Layout& layout, const std::vector<char>& data, GaussianCloud& cloud) {
  const std::size_t in_channel = higher_harmonics(layout.degree);
  for (std::size_t k = 0; k < in_channel; ++k) {
    Vec3& out = cloud.harmonics.emplace_back();
    for (std::size_t c = 0; c < 3; ++c) {
      float value;
      std::memcpy(&value, data.data() + *layout.higher[c * in_channel + k], sizeof(value));
      if (!std::isfinite(value))
        return fmt::format("{}{} is {}; expected a finite number", kHigher, c * in_channel + k, value);
      out[static_cast<int>(c)] = value;
    }
  }
  return std::nullopt;
}

}  // namespace

bool is_gaussian_ply(const fs::path& file) {
  const std::string head = beginning(file);
  if (!head.starts_with("ply")) return false;
  std::istringstream lines(head);
  for (std::string line; std::getline(lines, line) && !line.starts_with("end_header");)
    if (line.starts_with("property ") && line.find(" f_dc_0") != line.npos) return true;
  return false;
}

Scene load_gaussian_ply(const fs::path& file) {
  const auto fail = [&](const std::string& why) { throw SceneError(file.string(), "", why); };
  const std::string head = beginning(file);
  const Layout layout = HeaderReader(file, head).read();
  std::error_code error;
  const std::uintmax_t bytes = fs::file_size(file, error);
  if (error) fail("cannot be read");
  const std::uint64_t room = bytes - std::min<std::uintmax_t>(bytes, layout.begin);
  if (layout.count == 0) fail("the file has no Gaussians");
  if (layout.count > room / layout.stride)
    fail(fmt::format("the header announces {} Gaussians of {} bytes each, and {} bytes follow it", layout.count,
                     layout.stride, room));
  Scene scene;
  try {
    MemoryBudget memory(MemoryBudget::of_process());
    memory.take(layout.count * (sizeof(Gaussian) + layout.higher.size() * sizeof(float)));
    scene.gaussians.shapes.reserve(layout.count);
    scene.gaussians.harmonics.reserve(layout.count * higher_harmonics(layout.degree));
  } catch (const std::bad_alloc&) {
    fail("not enough memory to load it");
  } catch (const std::length_error& too_much) {
    fail(std::string("the file ") + too_much.what());
  }
  std::ifstream in(file, std::ios::binary);
  in.seekg(static_cast<std::streamoff>(layout.begin));
  std::vector<char> data(layout.stride);
  for (std::uint64_t i = 0; i < layout.count; ++i) {
    if (!in.read(data.data(), static_cast<std::streamsize>(data.size()))) fail("reading failed");
    Row row;
    for (std::size_t k = 0; k < row.size(); ++k) std::memcpy(&row[k], data.data() + *layout.at[k], sizeof(float));
    if (const std::optional<std::string> wrong = add(row, scene.gaussians))
      fail(fmt::format("Gaussian {}: {}", i, *wrong));
    if (const std::optional<std::string> wrong = add_harmonics(layout, data, scene.gaussians))
      fail(fmt::format("Gaussian {}: {}", i, *wrong));
  }
  scene.gaussians.display = true;
  scene.gaussians.degree = layout.degree;
  scene.name = plain_text(file.stem().string());
  scene.cameras.push_back(fitted_camera(scene));
  scene.added.camera = true;
  return scene;
}

}  // namespace carousel::scene
