#include "ringbus/cycle/memory/dram/dram_queue.h"

namespace carousel::ringbus::cycle {

/// The first of the line from this entry on that is for the open row.
void DramQueue::find_hit(std::uint32_t bank, std::uint32_t from, std::uint64_t open_row) {
  while (from != kNone && entries_[from].request.row != open_row) from = entries_[from].behind;
  lines_[bank].hit = from;
  if (from != kNone) lines_[bank].hit_order = entries_[from].order;
  hits_ = (hits_ & ~(std::uint64_t{1} << bank)) | std::uint64_t{from != kNone} << bank;
}

/// The first that is not.
void DramQueue::find_other(std::uint32_t bank, std::uint32_t from, std::uint64_t open_row) {
  while (from != kNone && entries_[from].request.row == open_row) from = entries_[from].behind;
  lines_[bank].other = from;
  if (from != kNone) lines_[bank].other_order = entries_[from].order;
  others_ = (others_ & ~(std::uint64_t{1} << bank)) | std::uint64_t{from != kNone} << bank;
}

void DramQueue::open_row(std::uint32_t bank, std::uint64_t row) {
  if ((others_ >> bank & 1) == 0) return;
  find_hit(bank, lines_[bank].first, row);
  find_other(bank, lines_[bank].first, row);
}

void DramQueue::close_row(std::uint32_t bank) {
  Line& line = lines_[bank];
  if (line.first == kNone) return;
  line.hit = kNone;
  line.other = line.first;
  line.other_order = entries_[line.first].order;
  hits_ &= ~(std::uint64_t{1} << bank);
  others_ |= std::uint64_t{1} << bank;
}

void DramQueue::push(const DramRequest& request, DramCycle now, std::uint64_t open_row) {
  std::uint32_t index = static_cast<std::uint32_t>(entries_.size());
  if (free_.empty()) {
    entries_.emplace_back();
  } else {
    index = free_.back();
    free_.pop_back();
  }
  Line& line = lines_[request.bank];
  entries_[index] = {request, now, taken_++, line.last, kNone, false};
  (line.last == kNone ? line.first : entries_[line.last].behind) = index;
  line.last = index;
  if (request.row == open_row) {
    if (line.hit == kNone) find_hit(request.bank, index, open_row);
  } else if (line.other == kNone) {
    find_other(request.bank, index, open_row);
  }
  ++size_;
}

DramQueue::Entry DramQueue::take(std::uint32_t index, std::uint64_t open_row) {
  const Entry out = entries_[index];
  Line& line = lines_[out.request.bank];
  (out.before == kNone ? line.first : entries_[out.before].behind) = out.behind;
  (out.behind == kNone ? line.last : entries_[out.behind].before) = out.before;
  if (line.hit == index) find_hit(out.request.bank, out.behind, open_row);
  if (line.other == index) find_other(out.request.bank, out.behind, open_row);
  free_.push_back(index);
  --size_;
  return out;
}

}  // namespace carousel::ringbus::cycle
