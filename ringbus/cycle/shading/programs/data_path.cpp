#include "ringbus/cycle/shading/programs/data_path.h"

#include <algorithm>
#include <optional>

namespace carousel::ringbus::cycle {

namespace {

constexpr int kTableBits = 40;

}  // namespace

DataPath::DataPath(const DataCacheConfig& cache, const TranslationConfig& pages, std::uint32_t worker,
                   ProgramMemory& memory)
    : memory_(memory),
      worker_(worker),
      line_bytes_(memory.line_bytes()),
      ways_(static_cast<std::size_t>(cache.ways)),
      latency_(cache.bytes > 0 ? static_cast<Cycle>(cache.latency_cycles) : 0),
      pages_(pages.page_bytes, pages.entries) {
  if (cache.bytes > 0) {
    if (cache.line_bytes) line_bytes_ = static_cast<std::uint64_t>(*cache.line_bytes);
    sets_.resize(static_cast<std::size_t>(cache.bytes) / (line_bytes_ * ways_));
  }
}

void DataPath::read(ShadeData what, const DataRead& data, const ProgramRead& by, Cycle now) {
  const std::uint64_t address = (static_cast<std::uint64_t>(what) << kTableBits) + data.offset;
  due(take_port(now), What::kPage, begin({what, data.offset, address, by}));
}

/// The next cycle in which the port of TLB and cache is free.
Cycle DataPath::take_port(Cycle now) {
  const Cycle at = std::max(now, port_free_);
  port_free_ = at + 1;
  return at;
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
  if (!pages_.on()) return look_up_line(line, now);
  using Found = Translator<std::uint32_t>::Found;
  ++counts_.pages;
  const Found found = pages_.look_up(lines_[line].address, line);
  if (found == Found::kHere) return look_up_line(line, now);
  ++counts_.page_misses;
  if (found == Found::kWalks) read_entry(now);
}

/// The walker reads the next level for its page.
void DataPath::read_entry(Cycle now) {
  if (pages_.begins()) ++counts_.walks;
  memory_.read(ShadeData::kPages, {pages_.entry(), Translator<std::uint32_t>::kEntryBytes},
               {.worker = worker_, .to = ProgramRead::To::kWalker}, now);
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
  if (const std::optional<std::vector<std::uint32_t>> waited = pages_.take())
    for (const std::uint32_t line : *waited) due(take_port(now), What::kLine, line);
  if (pages_.walks()) read_entry(now);
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
