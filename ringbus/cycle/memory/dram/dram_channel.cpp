#include "ringbus/cycle/memory/dram/dram_channel.h"

#include <algorithm>

namespace carousel::ringbus::cycle {

DramChannel::DramChannel(const DramTiming& timing, std::size_t places)
    : timing_(timing),
      places_(places),
      high_(places - places / 4),
      low_(places / 4),
      banks_(timing.all_banks()),
      groups_(timing.pseudo_channels * timing.groups),
      pseudos_(timing.pseudo_channels),
      refresh_due_(timing.refi),
      next_(timing.refi) {}

void DramChannel::push(const DramRequest& request, DramCycle now) {
  idle_until(now);
  arrivals_[request.write].push_back({request, now});
  ++held_;
  next_ = std::min(next_, std::max(now, now_));
}

void DramChannel::idle_until(DramCycle now) {
  while (held_ == 0 && next_ < now) step();
}

/// At most one request a cycle takes a place.
void DramChannel::take_arrivals(DramCycle now) {
  for (const bool write : {false, true}) {
    std::deque<Arrival>& arrivals = arrivals_[write];
    if (arrivals.empty() || arrivals.front().at > now || queues_[write].size() >= places_) continue;
    queues_[write].push_back({arrivals.front().request, now});
    arrivals.pop_front();
    last_taken_ = now;
    return;
  }
}

void DramChannel::choose_kind() {
  const std::size_t reads = queues_[0].size(), writes = queues_[1].size();
  if (writing_)
    writing_ = writes > (reads > 0 ? low_ : 0);
  else
    writing_ = writes >= high_ || (reads == 0 && writes > 0);
}

void DramChannel::use_row_bus(DramCycle until) {
  row_bus_ = until;
  if (!timing_.two_buses) column_bus_ = until;
}
void DramChannel::use_column_bus(DramCycle until) {
  column_bus_ = until;
  if (!timing_.two_buses) row_bus_ = until;
}

/// The earliest cycle of the read or write of a request whose row is open.
DramCycle DramChannel::column_time(const Entry& entry) const {
  const std::uint32_t bank = entry.request.bank, group = bank / timing_.banks;
  const std::size_t kind = entry.request.write;
  return std::max({banks_[bank].column[kind], groups_[group].column[kind],
                   pseudos_[group / timing_.groups].column[kind], column_bus_});
}

DramCycle DramChannel::activate_time(std::uint32_t bank) const {
  const std::uint32_t group = bank / timing_.banks;
  const Pseudo& pseudo = pseudos_[group / timing_.groups];
  return std::max(
      {banks_[bank].activate, groups_[group].activate, pseudo.activate, pseudo.last[pseudo.turn], row_bus_});
}

DramChannel::Issued DramChannel::step() {
  const DramCycle now = next_;
  if (now >= refresh_due_ && refresh_ == Refresh::kNone) {
    refresh_ = Refresh::kClose;
    refresh_due_ += timing_.refi;
  }
  take_arrivals(now);
  choose_kind();
  std::vector<Entry>& queue = queues_[writing_];
  constexpr std::size_t kNone = ~std::size_t{0};
  std::size_t active = kNone, column = kNone, row = kNone;
  std::size_t other_row = kNone;  // the row command behind `row` that is for another bank
  DramCycle wake = refresh_due_;
  const auto same_bank = [&](std::size_t a, std::size_t b) { return queue[a].request.bank == queue[b].request.bank; };
  const auto consider = [&](std::size_t& chosen, std::size_t index, DramCycle at) {
    if (at > now)
      wake = std::min(wake, at);
    else if (chosen == kNone)
      chosen = index;
  };
  for (std::size_t i = 0; i < active_.size() && active == kNone; ++i) consider(active, i, column_time(active_[i]));
  if (refresh_ == Refresh::kNone && (active == kNone || timing_.two_buses)) {
    for (std::size_t i = 0; i < queue.size(); ++i) {
      const Bank& bank = banks_[queue[i].request.bank];
      if (bank.row == queue[i].request.row) {
        if (column == kNone) consider(column, i, column_time(queue[i]));
      } else {
        std::size_t& chosen = row != kNone && !same_bank(row, i) ? other_row : row;
        if (bank.row == kClosed)
          consider(chosen, i, activate_time(queue[i].request.bank));
        else if (bank.activated == 0)
          consider(chosen, i, std::max(bank.precharge, row_bus_));
      }
      // Behind these nothing goes before them.
      if (!timing_.two_buses ? column != kNone || row != kNone
                             : column != kNone && row != kNone && (other_row != kNone || !same_bank(column, row)))
        break;
    }
    // The row of a request that is served in this cycle stays open.
    if (active == kNone && column != kNone && row != kNone && queue[row].request.bank == queue[column].request.bank)
      row = other_row;
  }
  Issued issued;
  bool any = false;
  if (active != kNone) {
    issued = issue_column(active_, active, now);
    any = true;
  } else if (column != kNone) {
    issued = issue_column(queue, column, now);
    if (row != kNone && row > column) --row;
    any = true;
  }
  if (row != kNone && (timing_.two_buses || !any)) {
    issue_row(queue, row, now);
    any = true;
  }
  if (refresh_ != Refresh::kNone && active_.empty()) refresh(now, wake);
  for (const bool write : {false, true})
    if (!arrivals_[write].empty() && queues_[write].size() < places_)
      wake = std::min(wake, arrivals_[write].front().at);
  next_ = any ? now + 1 : std::max(wake, now + 1);
  now_ = now + 1;
  return issued;
}

/// Closes all rows with one command as soon as all may be closed, and refreshes when all banks could be activated.
void DramChannel::refresh(DramCycle now, DramCycle& wake) {
  if (refresh_ == Refresh::kClose) {
    DramCycle at = row_bus_;
    bool open = false;
    for (const Bank& bank : banks_) {
      if (bank.row == kClosed) continue;
      open = true;
      at = std::max(at, bank.precharge);
    }
    if (open && at > now) {
      wake = std::min(wake, at);
      return;
    }
    if (open) {
      for (Bank& bank : banks_) {
        if (bank.row == kClosed) continue;
        bank.row = kClosed;
        bank.activate = std::max(bank.activate, now + timing_.rp);
      }
      use_row_bus(now + 1);
    }
    refresh_ = Refresh::kRefresh;
  }
  DramCycle at = row_bus_;
  for (const Bank& bank : banks_) at = std::max(at, bank.activate);
  wake = std::min(wake, std::max(at, now + 1));
  if (at > now) return;
  for (Bank& bank : banks_) bank.activate = now + timing_.rfc;
  use_row_bus(now + 1);
  refresh_ = Refresh::kNone;
  ++counts_.refreshes;
  counts_.refresh_cycles += static_cast<std::uint64_t>(timing_.rfc);
}

DramChannel::Issued DramChannel::issue_column(std::vector<Entry>& from, std::size_t index, DramCycle now) {
  const Entry entry = from[index];
  from.erase(from.begin() + static_cast<std::ptrdiff_t>(index));
  Bank& bank = banks_[entry.request.bank];
  Group& group = groups_[entry.request.bank / timing_.banks];
  Pseudo& pseudo = pseudos_[entry.request.bank / timing_.banks / timing_.groups];
  const bool write = entry.request.write;
  const auto not_before = [](DramCycle& time, DramCycle at) { time = std::max(time, at); };
  not_before(group.column[write], now + timing_.ccd_long);
  not_before(pseudo.column[write], now + timing_.ccd_short);
  const DramCycle done = now + (write ? timing_.cwl : timing_.cl) + timing_.bl;
  if (write) {
    not_before(bank.precharge, done + timing_.wr);
    not_before(group.column[0], done + timing_.wtr_long);
    not_before(pseudo.column[0], done + timing_.wtr_short);
  } else {
    not_before(bank.precharge, now + timing_.rtp);
    not_before(pseudo.column[1], now + timing_.read_to_write);
  }
  use_column_bus(now + 1);
  if (&from == &active_) --bank.activated;
  if (!entry.counted) ++counts_.row_hits;
  ++(write ? counts_.writes : counts_.reads);
  if (!write) latencies_.add(static_cast<std::uint64_t>(done - entry.taken));
  --held_;
  return {true, entry.request, done};
}

/// The activate or the precharge that a request needs.
void DramChannel::issue_row(std::vector<Entry>& from, std::size_t index, DramCycle now) {
  Entry& entry = from[index];
  Bank& bank = banks_[entry.request.bank];
  if (bank.row != kClosed) {
    if (!entry.counted) ++counts_.row_conflicts;
    entry.counted = true;
    bank.row = kClosed;
    bank.activate = std::max(bank.activate, now + timing_.rp);
    use_row_bus(now + 1);
    return;
  }
  if (!entry.counted) ++counts_.row_misses;
  entry.counted = true;
  Group& group = groups_[entry.request.bank / timing_.banks];
  Pseudo& pseudo = pseudos_[entry.request.bank / timing_.banks / timing_.groups];
  bank.row = entry.request.row;
  bank.column = {now + timing_.rcd_read, now + timing_.rcd_write};
  bank.precharge = now + timing_.ras;
  bank.activate = now + timing_.rc;
  ++bank.activated;
  group.activate = now + timing_.rrd_long;
  pseudo.activate = now + timing_.rrd_short;
  pseudo.last[pseudo.turn] = now + timing_.faw;
  pseudo.turn = (pseudo.turn + 1) % 4;
  use_row_bus(now + timing_.activate_cycles);
  active_.push_back(entry);
  from.erase(from.begin() + static_cast<std::ptrdiff_t>(index));
}

}  // namespace carousel::ringbus::cycle
