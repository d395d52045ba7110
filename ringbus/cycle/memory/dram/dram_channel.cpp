#include "ringbus/cycle/memory/dram/dram_channel.h"

#include <algorithm>
#include <utility>

namespace carousel::ringbus::cycle {

DramChannel::DramChannel(const DramTiming& timing, std::size_t places)
    : timing_(timing),
      places_(places),
      high_(places - places / 4),
      low_(places / 4),
      queues_{DramQueue(timing.all_banks()), DramQueue(timing.all_banks())},
      banks_(timing.all_banks()),
      groups_(timing.pseudo_channels * timing.groups),
      pseudos_(timing.pseudo_channels),
      buses_(timing.two_buses),
      refresh_due_(timing.refi),
      next_(timing.refi) {
  for (std::uint32_t i = 0; i < banks_.size(); ++i) {
    banks_[i].group = i / timing.banks;
    banks_[i].pseudo = groups_[i / timing.banks].pseudo = i / timing.banks / timing.groups;
  }
}

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
const DramRequest* DramChannel::take_arrivals(DramCycle now) {
  for (const bool write : {false, true}) {
    Fifo<Arrival>& arrivals = arrivals_[write];
    if (arrivals.empty() || arrivals.front().at > now || queues_[write].size() >= places_) continue;
    arrived_ = arrivals.front().request;
    arrivals.pop_front();
    queues_[write].push(arrived_, now, banks_[arrived_.bank].row);
    last_taken_ = now;
    return &arrived_;
  }
  return nullptr;
}

/// True if writes are served next. The answer stays until a request comes or leaves.
bool DramChannel::next_kind() const {
  const std::size_t reads = queues_[0].size(), writes = queues_[1].size();
  return writing_ ? writes > (reads > 0 ? low_ : 0) : writes >= high_ || (reads == 0 && writes > 0);
}

DramChannel::Issued DramChannel::step() {
  const DramCycle now = next_;
  if (now > now_) writing_ = next_kind();  // in the cycle behind the last step, which may have been skipped
  bool changed = false;
  if (now >= refresh_due_ && refresh_ == Refresh::kNone) {
    refresh_ = Refresh::kClose;
    refresh_due_ += timing_.refi;
    changed = true;
  }
  const DramRequest* const arrived = take_arrivals(now);
  writing_ = next_kind();
  if (changed || writing_ != planned_writes_)
    plan(now);
  else if (arrived != nullptr && arrived->write == writing_ && refresh_ == Refresh::kNone)
    consider(arrived->bank, now);
  bool column = column_.at <= now, row = row_.at <= now;
  if (column && row) {
    if (!timing_.two_buses) {
      column = column_.active || column_.order < row_.order;
      row = !column;
    } else if (!column_.active && column_.bank == row_.bank) {
      // The row of a request that is served in this cycle stays open.
      first_row(queues_[writing_].others() & ~activated_ & ~(std::uint64_t{1} << row_.bank), now, row_);
      row = row_.at <= now;
    }
  }
  const std::optional<Plan> started = std::exchange(behind_clock_, std::nullopt);
  if (started) column = true, row = false;
  const bool further = !started && further_command(column, row, now);
  if (further) column = row = false;
  Issued issued;
  if (column) issued = issue_column(started ? *started : column_, now);
  if (row) issue_row(row_, now);
  DramCycle wake = refresh_due_;
  if (refresh_ != Refresh::kNone && active_.empty() && !half_) {
    refresh(now, wake);
    changed = refresh_ == Refresh::kNone;
  }
  if (changed || further || started)
    plan(now + 1);
  else if (column || row)
    plan_behind(now + 1, column, row);
  wake = std::min({wake, column_.at, row_.at});
  for (const bool write : {false, true})
    if (!arrivals_[write].empty() && queues_[write].size() < places_)
      wake = std::min(wake, arrivals_[write].front().at);
  next_ = half_ || behind_clock_ ? now + 1 : std::max(wake, now + 1);
  now_ = now + 1;
  return issued;
}

/// The second of two activate commands, or that which starts the data clock, if one of them goes before what was
/// chosen.
bool DramChannel::further_command(bool column, bool row, DramCycle now) {
  const bool stopped = column && timing_.clock_post > 0 && now >= clock_stops_;
  const DramCycle needed = stopped ? now + 1 : now;  // the cycle that the chosen command takes last
  if (half_ && (needed >= half_->latest || (!column && !row))) {
    open_for(half_->entry);
    half_.reset();
    buses_.use_row(now + 1);
    return true;
  }
  if (!stopped) return false;
  behind_clock_ = column_;
  buses_.use_column(now + 1);
  return true;
}

void DramChannel::set_row(std::uint32_t bank, std::uint64_t row) {
  banks_[bank].row = row;
  const std::uint64_t bit = std::uint64_t{1} << bank;
  open_ = row == kClosed ? open_ & ~bit : open_ | bit;
  for (DramQueue& queue : queues_) {
    if (row == kClosed)
      queue.close_row(bank);
    else
      queue.open_row(bank, row);
  }
}

/// Closes all rows with one command as soon as all may be closed, and refreshes when all banks could be activated.
void DramChannel::refresh(DramCycle now, DramCycle& wake) {
  if (refresh_ == Refresh::kClose) {
    DramCycle at = std::max(buses_.row_free(), precharge_);
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
      for (std::uint32_t i = 0; i < banks_.size(); ++i) {
        Bank& bank = banks_[i];
        if (bank.row == kClosed) continue;
        set_row(i, kClosed);
        bank.activate = std::max(bank.activate, now + timing_.rp);
      }
      buses_.use_row(now + 1);
      precharge_ = now + timing_.ppd;
    }
    refresh_ = Refresh::kRefresh;
  }
  DramCycle at = buses_.row_free();
  for (const Bank& bank : banks_) at = std::max(at, bank.activate);
  wake = std::min(wake, std::max(at, now + 1));
  if (at > now) return;
  for (Bank& bank : banks_) bank.activate = now + timing_.rfc;
  buses_.use_row(now + 1);
  refresh_ = Refresh::kNone;
  ++counts_.refreshes;
  counts_.refresh_cycles += static_cast<std::uint64_t>(timing_.rfc);
}

DramChannel::Issued DramChannel::issue_column(const Plan& column, DramCycle now) {
  Bank& bank = banks_[column.bank];
  Entry entry;
  if (column.active) {
    entry = active_[column.index];
    active_.erase(active_.begin() + static_cast<std::ptrdiff_t>(column.index));
    activated_ &= ~(std::uint64_t{1} << column.bank);
  } else {
    entry = queues_[column.write].take(column.index, bank.row);
  }
  Group& group = groups_[bank.group];
  Pseudo& pseudo = pseudos_[bank.pseudo];
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
  buses_.use_column(now + 1);
  clock_stops_ = std::max(clock_stops_, done + timing_.clock_post);
  if (!entry.counted) ++counts_.row_hits;
  ++(write ? counts_.writes : counts_.reads);
  if (!write) latencies_.add(static_cast<std::uint64_t>(done - entry.taken));
  --held_;
  return {true, entry.request, done};
}

/// The activate or the precharge that a request needs.
void DramChannel::issue_row(const Plan& row, DramCycle now) {
  DramQueue& queue = queues_[planned_writes_];
  Bank& bank = banks_[row.bank];
  Entry& waiting = queue.entry(row.index);
  if (bank.row != kClosed) {
    if (!waiting.counted) ++counts_.row_conflicts;
    waiting.counted = true;
    set_row(row.bank, kClosed);
    bank.activate = std::max(bank.activate, now + timing_.rp);
    buses_.use_row(now + 1);
    precharge_ = now + timing_.ppd;
    return;
  }
  if (!waiting.counted) ++counts_.row_misses;
  waiting.counted = true;
  const Entry entry = queue.take(row.index, kClosed);
  Group& group = groups_[bank.group];
  Pseudo& pseudo = pseudos_[bank.pseudo];
  bank.column = {now + timing_.rcd_read, now + timing_.rcd_write};
  bank.precharge = now + timing_.ras;
  bank.activate = now + timing_.rc;
  activated_ |= std::uint64_t{1} << row.bank;
  group.activate = now + timing_.rrd_long;
  pseudo.activate = now + timing_.rrd_short;
  pseudo.last[pseudo.turn] = now + timing_.faw;
  pseudo.turn = (pseudo.turn + 1) % 4;
  buses_.use_row(now + timing_.activate_cycles);
  if (timing_.aad > 0)
    half_ = {entry, now + timing_.aad};
  else
    open_for(entry);
}

/// The request has activated its row.
void DramChannel::open_for(const Entry& entry) {
  active_.push_back(entry);
  set_row(entry.request.bank, entry.request.row);
}

}  // namespace carousel::ringbus::cycle
