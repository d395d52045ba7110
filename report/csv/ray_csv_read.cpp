#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "core/system/error.h"
#include "core/system/input_file.h"
#include "core/text/line_reader.h"
#include "core/text/list_end.h"
#include "report/csv/ray_csv.h"
#include "report/csv/ray_csv_columns.h"

namespace carousel::report {

namespace {

constexpr std::size_t kMostIssues = 20;
constexpr std::size_t kLongestLine = 4096;
constexpr std::size_t kNowhere = ~std::size_t{0};

/// The values of one line and the columns (from 1) they begin at: those of the ray, then that of its flags.
struct Cells {
  std::array<std::string_view, kRayColumns + 1> text;
  std::array<int, kRayColumns + 1> column{};
  std::size_t count = 0;  // number of all cells, kept or not
};

/// Cell `flags` (from 0) is that of the flags.
Cells split(std::string_view line, std::size_t flags) {
  Cells cells;
  for (std::size_t begin = 0; begin <= line.size(); ++cells.count) {
    const std::size_t end = std::min(line.find(',', begin), line.size());
    if (cells.count < kRayColumns || cells.count == flags) {
      const std::size_t kept = std::min(cells.count, kRayColumns);
      cells.text[kept] = line.substr(begin, end - begin);
      cells.column[kept] = static_cast<int>(begin) + 1;
    }
    begin = end + 1;
  }
  return cells;
}

std::optional<float> read_float(std::string_view text) {
  float value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end != text.data() + text.size() || error == std::errc::invalid_argument) return std::nullopt;
  if (error == std::errc{}) return value;
  // Out of a float's range: too small rounds to 0, too large is refused.
  double wide = 0;
  std::from_chars(text.data(), text.data() + text.size(), wide);
  return std::abs(wide) < 1 ? std::optional(static_cast<float>(wide)) : std::nullopt;
}

class RayReader {
 public:
  RayReader(const std::string& name, std::size_t most) : name_(name), most_(most) {}

  RayBatch read(std::istream& in) {
    LineReader lines(in, kLongestLine);
    for (line_ = 1; issues_.size() < kMostIssues && lines.next(); ++line_) {
      const std::string& line = lines.line();
      if (lines.too_long()) {
        issue(0, fmt::format("expected a line of CSV, found one of more than {} bytes", kLongestLine));
      } else if (line_ == 1) {
        read_header(line);
        if (!issues_.empty()) break;  // the rest would only repeat it
      } else if (end_.take(line)) {
        if (const std::string fault = end_.fault(rays_.size(), "ray"); !fault.empty() && issues_.empty())
          issue(1, fault);
      } else if (rays_.size() == most_) {
        issue(0, fmt::format("expected at most {} rays, found more", most_));
        break;
      } else if (!line.empty()) {
        if (end_.found()) issue(1, "expected no ray behind the line that counts them");
        read_ray(line);
      }
    }
    if (line_ == 1 && issues_.empty()) issue(0, "expected the header " + header());
    if (rays_.empty() && issues_.empty()) issue(0, end_.fault(0, "ray"));
    if (in.bad()) throw FileError("cannot read " + name_);
    if (!issues_.empty()) throw ConfigError(std::move(issues_));
    return std::move(rays_);
  }

 private:
  static std::string header() {
    std::string out;
    for (std::size_t i = 0; i < kRayColumns; ++i) out += (i == 0 ? "" : ",") + std::string(kColumns[i]);
    return out;
  }

  void issue(int column, std::string message) { issues_.push_back({{name_, line_, column}, "", std::move(message)}); }

  void read_header(std::string_view line) {
    constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
    if (line.substr(0, 3) == kByteOrderMark) line.remove_prefix(3);
    const Cells cells = split(line, kNowhere);
    for (std::size_t i = 0; i < kRayColumns; ++i)
      if (cells.text[i] != kColumns[i])
        return issue(std::max(1, cells.column[i]), fmt::format("expected the header {}, found '{}' in place of {}",
                                                               header(), cells.text[i], kColumns[i]));
    std::size_t begin = 0;
    for (std::size_t cell = 0; begin <= line.size(); ++cell) {
      const std::size_t end = std::min(line.find(',', begin), line.size());
      if (cell >= kRayColumns && line.substr(begin, end - begin) == kFlagsColumn) {
        if (flags_ != kNowhere) return issue(static_cast<int>(begin) + 1, "there is a column flags already");
        flags_ = cell;
      }
      begin = end + 1;
    }
  }

  void read_ray(std::string_view line) {
    const Cells cells = split(line, flags_);
    if (cells.count < kRayColumns)
      return issue(1, fmt::format("expected at least {} values, found {}", kRayColumns, cells.count));
    const std::size_t before = issues_.size();
    RayRequest request;
    request.tag.path = static_cast<std::uint32_t>(rays_.size());
    request.tag.kind = kind(cells);
    request.tag.flags = flags(cells);
    std::array<float, 8> values{};
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = number(cells, i + 2);
    const auto& [ox, oy, oz, dx, dy, dz, tmin, tmax] = values;
    request.ray = {{ox, oy, oz}, tmin, {dx, dy, dz}, tmax};
    if (issues_.size() == before && dx == 0 && dy == 0 && dz == 0)
      issue(cells.column[5], "expected a direction, found 0,0,0");
    if (issues_.size() == before && !(tmin >= 0 && tmin <= tmax))
      issue(cells.column[8], fmt::format("expected 0 <= tmin <= tmax, found {} and {}", cells.text[8], cells.text[9]));
    if (issues_.size() == before) rays_.push_back(request);
  }

  RayKind kind(const Cells& cells) {
    const auto found = std::find(kRayKindNames.begin(), kRayKindNames.end(), cells.text[1]);
    if (found == kRayKindNames.end()) {
      issue(cells.column[1], fmt::format("expected camera, bounce or shadow, found '{}'", cells.text[1]));
      return RayKind::kCamera;
    }
    return static_cast<RayKind>(found - kRayKindNames.begin());
  }

  /// A line that ends before the column has none.
  std::uint8_t flags(const Cells& cells) {
    std::uint8_t out = 0;
    const std::string_view text = cells.text[kRayColumns];
    for (std::size_t begin = 0; !text.empty() && begin <= text.size();) {
      const std::size_t end = std::min(text.find('+', begin), text.size());
      const std::string_view word = text.substr(begin, end - begin);
      const auto* found =
          std::find_if(kFlagWords.begin(), kFlagWords.end(), [&](const FlagWord& each) { return each.word == word; });
      if (found == kFlagWords.end()) {
        issue(cells.column[kRayColumns] + static_cast<int>(begin),
              fmt::format("expected cull_back, cull_front or force_opaque, joined by +, found '{}'", word));
        return 0;
      }
      out |= static_cast<std::uint8_t>(found->flag);
      begin = end + 1;
    }
    return out;
  }

  float number(const Cells& cells, std::size_t cell) {
    const std::optional<float> value = read_float(cells.text[cell]);
    const bool may_be_infinite = kColumns[cell] == "tmax";
    if (!value || std::isnan(*value) || (std::isinf(*value) && !may_be_infinite)) {
      issue(cells.column[cell], fmt::format("expected a {}number for {}, found '{}'", may_be_infinite ? "" : "finite ",
                                            kColumns[cell], cells.text[cell]));
      return 1;
    }
    return *value;
  }

  const std::string& name_;
  const std::size_t most_;
  int line_ = 1;
  std::size_t flags_ = kNowhere;  // the cell of the flags
  ListEnd end_;
  RayBatch rays_;
  std::vector<ConfigIssue> issues_;
};

}  // namespace

RayBatch read_rays_csv(std::istream& in, const std::string& name, std::size_t most) {
  return RayReader(name, most).read(in);
}

RayBatch read_rays_csv(const std::filesystem::path& path) {
  std::error_code ignored;
  InputFile in(path);
  if (!in || std::filesystem::is_directory(path, ignored)) throw FileError("cannot read " + path.string());
  return read_rays_csv(in, path.string());
}

}  // namespace carousel::report
