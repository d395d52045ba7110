#include "ringbus/cycle/shading/programs/data_path.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace carousel::ringbus::cycle {

namespace {

constexpr int kTableBits = 40, kAddressBits = 48, kLevelBits = 9, kLevelTableBits = 44;
constexpr std::uint32_t kEntryBytes = 8;

}  // namespace

DataPath::DataPath(const DataCacheConfig& cache, const TranslationConfig& pages, std::uint32_t worker,
                   ProgramMemory& memory)
    : memory_(memory),
      worker_(worker),
      line_bytes_(memory.line_bytes()),
      ways_(static_cast<std::size_t>(cache.ways)),
      entries_(static_cast<std::size_t>(pages.entries)),
      latency_(cache.bytes > 0 ? static_cast<Cycle>(cache.latency_cycles) : 0) {
  if (cache.bytes > 0) {
    if (cache.line_bytes) line_bytes_ = static_cast<std::uint64_t>(*cache.line_bytes);
    sets_.resize(static_cast<std::size_t>(cache.bytes) / (line_bytes_ * ways_));
  }
  if (pages.page_bytes > 0) {
    page_bits_ = std::countr_zero(static_cast<std::uint64_t>(pages.page_bytes));
    levels_ = static_cast<std::uint32_t>((kAddressBits - page_bits_ + kLevelBits - 1) / kLevelBits);
  }
}

void DataPath::read(ShadeData what, const DataRead& data, const ProgramRead& by, Cycle now) {
  const Cycle sent = std::max(now, port_free_);
  port_free_ = sent + 1;
  const std::uint64_t address = (static_cast<std::uint64_t>(what) << kTableBits) + data.offset;
  due(sent, What::kPage, begin({what, data.offset, address, by}));
}

std::uint32_t DataPath::begin(const Line& line) {
  if (free_.empty()) {
    lines_.push_back(line);
    return static_cast<std::uint32_t>(lines_.size() - 1);
  }
  const std::uint32_t index = free_.back();
  free_.pop_back();
  lines_[index] = line;
  return index;
}

void DataPath::look_up_page(std::uint32_t line, Cycle now) {
  if (levels_ == 0) return look_up_line(line, now);
  const std::uint64_t page = lines_[line].address >> page_bits_;
  ++counts_.pages;
  if (use(tlb_, page)) return look_up_line(line, now);
  ++counts_.page_misses;
  const auto walk = std::ranges::find(walks_, page, &Walk::page);
  if (walk != walks_.end()) return walk->lines.push_back(line);
  walks_.push_back({page, {line}});
  if (walks_.size() == 1) read_level(now);
}

/// The walker reads the next level for its page.
void DataPath::read_level(Cycle now) {
  if (level_ == 0) ++counts_.walks;
  const std::uint64_t entry = walks_.front().page >> (kLevelBits * static_cast<int>(levels_ - 1 - level_));
  const std::uint64_t offset = (std::uint64_t{level_} << kLevelTableBits) + entry * kEntryBytes;
  memory_.read(ShadeData::kPages, {offset, kEntryBytes}, {.worker = worker_, .to = ProgramRead::To::kWalker}, now);
  ++counts_.walk_reads;
}

void DataPath::look_up_line(std::uint32_t line, Cycle now) {
  if (sets_.empty()) return ask(line, now);
  const std::uint64_t address = lines_[line].address;
  lines_[line].known = now + latency_;
  ++counts_.lines;
  if (use(set_of(address), address)) {
    ++counts_.hits;
    return due(lines_[line].known, What::kAnswer, line);
  }
  const auto [coming, first] = coming_.try_emplace(address);
  coming->second.push_back(line);
  if (!first) return;
  ++counts_.misses;
  due(lines_[line].known, What::kAsk, line);
}

void DataPath::ask(std::uint32_t line, Cycle now) {
  const Line& of = lines_[line];
  const DataRead data{of.offset, static_cast<std::uint32_t>(line_bytes_)};
  if (sets_.empty()) {
    memory_.read(of.what, data, of.by, now);
    free_.push_back(line);
  } else {
    memory_.read(of.what, data, {.worker = worker_, .to = ProgramRead::To::kCache, .address = of.address}, now);
  }
}

void DataPath::take(const ProgramRead& read, Cycle now) {
  if (read.to == ProgramRead::To::kCache) {
    put(set_of(read.address), ways_, read.address);
    for (const std::uint32_t line : coming_.at(read.address))
      due(std::max(now, lines_[line].known), What::kAnswer, line);
    coming_.erase(read.address);
    return;
  }
  if (++level_ < levels_) return read_level(now);
  level_ = 0;
  const Walk done = std::move(walks_.front());
  walks_.pop_front();
  put(tlb_, entries_, done.page);
  for (const std::uint32_t line : done.lines) look_up_line(line, now);
  if (!walks_.empty()) read_level(now);
}

bool DataPath::use(Names& names, std::uint64_t name) {
  const auto at = std::ranges::find(names, name);
  if (at == names.end()) return false;
  std::rotate(at, at + 1, names.end());
  return true;
}

void DataPath::put(Names& names, std::size_t most, std::uint64_t name) {
  if (names.size() == most) names.erase(names.begin());
  names.push_back(name);
}

}  // namespace carousel::ringbus::cycle
