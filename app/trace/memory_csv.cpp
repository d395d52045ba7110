#include "app/trace/memory_csv.h"

#include <array>
#include <charconv>
#include <string_view>

#include <fmt/format.h>

#include "core/system/error.h"
#include "core/system/input_file.h"
#include "core/text/line_reader.h"
#include "core/text/list_end.h"

namespace carousel::app {

namespace {

constexpr std::string_view kHeader = "cycle,kind,address,bytes";
constexpr std::size_t kColumns = 4, kMostIssues = 20, kLongestLine = 256;
constexpr std::uint64_t kLastCycle = 1'000'000'000'000, kLastAddress = ringbus::kMemoryEnd - 1, kMostOfRequest = 65536;

class MemoryReader {
 public:
  MemoryReader(const std::string& name, std::size_t most) : name_(name), most_(most) {}

  ringbus::MemoryLog read(std::istream& in) {
    LineReader lines(in, kLongestLine);
    for (line_ = 1; issues_.size() < kMostIssues && requests_.size() <= most_ && lines.next(); ++line_) {
      const std::string& line = lines.line();
      if (lines.too_long()) {
        issue(0, fmt::format("expected a line of CSV, found one of more than {} bytes", kLongestLine));
        break;
      }
      if (line_ == 1 && line != kHeader) issue(1, fmt::format("expected the header {}, found '{}'", kHeader, line));
      if (line_ > 1 && !line.empty()) read_line(line);
    }
    if (line_ == 1) issue(0, fmt::format("expected the header {}", kHeader));
    if (requests_.empty() && issues_.empty()) issue(0, end_.fault(0, "request"));
    if (in.bad()) throw FileError("cannot read " + name_);
    if (!issues_.empty()) throw ConfigError(std::move(issues_));
    return std::move(requests_);
  }

 private:
  void issue(int column, std::string message) { issues_.push_back({{name_, line_, column}, "", std::move(message)}); }

  void read_line(std::string_view line) {
    if (end_.take(line)) {
      if (const std::string fault = end_.fault(requests_.size(), "request"); !fault.empty() && issues_.empty())
        issue(1, fault);
      return;
    }
    if (end_.found()) issue(1, "expected no request behind the line that counts them");
    read_request(line);
  }

  void read_request(std::string_view line) {
    std::array<std::string_view, kColumns> cells;
    std::array<int, kColumns> columns{};
    std::size_t count = 0;
    for (std::size_t begin = 0; begin <= line.size(); ++count) {
      const std::size_t end = std::min(line.find(',', begin), line.size());
      if (count < kColumns) {
        cells[count] = line.substr(begin, end - begin);
        columns[count] = static_cast<int>(begin) + 1;
      }
      begin = end + 1;
    }
    if (count != kColumns) return issue(1, fmt::format("expected {} values, found {}", kColumns, count));
    const auto number = [&](std::size_t i, std::uint64_t min, std::uint64_t max) {
      std::uint64_t value = 0;
      const char* last = cells[i].data() + cells[i].size();
      const auto [end, error] = std::from_chars(cells[i].data(), last, value);
      if (error != std::errc{} || end != last || value < min || value > max)
        issue(columns[i], fmt::format("expected a whole number from {} to {}, found '{}'", min, max, cells[i]));
      return value;
    };
    ringbus::MemoryRequest request;
    request.cycle = number(0, 0, kLastCycle);
    request.write = cells[1] == "write";
    if (!request.write && cells[1] != "read")
      issue(columns[1], fmt::format("expected read or write, found '{}'", cells[1]));
    request.address = number(2, 0, kLastAddress);
    request.bytes = static_cast<std::uint32_t>(number(3, 1, kMostOfRequest));
    if (requests_.size() == most_) issue(0, fmt::format("expected at most {} requests, found more", most_));
    if (!requests_.empty() && request.cycle < requests_.back().cycle)
      issue(columns[0], fmt::format("requests stand in the order of their cycles; expected at least {}, found {}",
                                    requests_.back().cycle, request.cycle));
    requests_.push_back(request);
  }

  const std::string& name_;
  const std::size_t most_;
  int line_ = 1;
  std::vector<ConfigIssue> issues_;
  ListEnd end_;
  ringbus::MemoryLog requests_;
};

}  // namespace

void write_memory_csv(AtomicFile& file, const ringbus::MemoryLog& requests, bool complete) {
  file.write(fmt::format("{}\n", kHeader));
  for (const ringbus::MemoryRequest& request : requests)
    file.write(
        fmt::format("{},{},{},{}\n", request.cycle, request.write ? "write" : "read", request.address, request.bytes));
  file.write(list_end(requests.size(), complete) + "\n");
}

ringbus::MemoryLog read_memory_csv(std::istream& in, const std::string& name, std::size_t most) {
  return MemoryReader(name, most).read(in);
}

ringbus::MemoryLog read_memory_csv(const std::filesystem::path& path) {
  InputFile in(path);
  if (!in) throw FileError("cannot read " + path.string());
  return read_memory_csv(in, path.string());
}

}  // namespace carousel::app
