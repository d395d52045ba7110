// Which command of a channel is issued next, and when.
#include <algorithm>
#include <bit>

#include "ringbus/cycle/memory/dram/dram_channel.h"

namespace carousel::ringbus::cycle {

/// The earliest cycle of the read or write of a request whose row is open.
DramCycle DramChannel::column_time(std::uint32_t bank, bool write) const {
  return std::max({banks_[bank].column[write], groups_[banks_[bank].group].column[write],
                   pseudos_[banks_[bank].pseudo].column[write], buses_.column_free()});
}

/// The earliest cycle of an activate in a group, as far as its banks have a say in common.
DramCycle DramChannel::activate_gate(const Group& group) const {
  const Pseudo& pseudo = pseudos_[group.pseudo];
  return std::max({group.activate, pseudo.activate, pseudo.last[pseudo.turn], buses_.row_free()});
}

/// The next commands, which are not issued before `from`.
void DramChannel::plan(DramCycle from) {
  planned_writes_ = next_kind();
  plan_columns(from);
  plan_rows(from);
}

void DramChannel::plan_columns(DramCycle from) {
  column_.at = kDramNever;
  column_.active = false;
  for (std::uint32_t i = 0; i < active_.size(); ++i) consider_active(i, from);
  if (refresh_ != Refresh::kNone) return;
  for (std::uint64_t banks = queues_[planned_writes_].hits(); banks != 0; banks &= banks - 1)
    consider_column(static_cast<std::uint32_t>(std::countr_zero(banks)), from);
}

void DramChannel::plan_rows(DramCycle from) {
  row_.at = kDramNever;
  if (refresh_ != Refresh::kNone) return;
  for (Group& group : groups_) group.gate = activate_gate(group);
  first_row(queues_[planned_writes_].others() & ~activated_, from, row_);
}

/// Behind commands that were issued in the cycle before `from`: a read or a write changes the time of no row command
/// but that of its bank, and a row command likewise, unless one waits for the bus that it took.
void DramChannel::plan_behind(DramCycle from, bool column, bool row) {
  if (next_kind() != planned_writes_) {
    plan(from);
    return;
  }
  const std::uint32_t bank = column_.bank;
  const bool rows = row || row_.at < from || row_.bank == bank;
  if (column || column_.at < std::max(from, buses_.column_free()) || (!column_.active && row_.bank == column_.bank))
    plan_columns(from);
  else if (!active_.empty())
    consider_active(static_cast<std::uint32_t>(active_.size() - 1), from);
  if (rows)
    plan_rows(from);
  else if (refresh_ == Refresh::kNone)
    consider_row(bank, from);
}

void DramChannel::consider_active(std::uint32_t index, DramCycle from) {
  const DramRequest& request = active_[index].request;
  const DramCycle at = std::max(from, column_time(request.bank, request.write));
  if (at < column_.at || (at == column_.at && !column_.active))
    column_ = {at, 0, index, request.bank, true, request.write};
}

void DramChannel::consider_column(std::uint32_t bank, DramCycle from) {
  const DramQueue::Line& line = queues_[planned_writes_].line(bank);
  const DramCycle at = std::max(from, column_time(bank, planned_writes_));
  if (at < column_.at || (at == column_.at && !column_.active && line.hit_order < column_.order))
    column_ = {at, line.hit_order, line.hit, bank, false, planned_writes_};
}

/// The first row command of these banks, each of which has a request of a row that is not open. There is none if all of
/// them need an activate while the second command of another is awaited.
/// One number is compared: the cycle, then the order of taking, then the bank. So there is no branch that a processor
/// cannot foresee.
/// The times are those of commands and a refresh, far below 2^26 cycles from now; and no request waits for 2^31 others,
/// since the oldest goes first as soon as it can.
void DramChannel::first_row(std::uint64_t banks, DramCycle from, Plan& row) const {
  constexpr std::uint32_t kOrderBits = 32, kBankBits = 6, kBankMask = (1u << kBankBits) - 1;
  row.at = kDramNever;
  if (banks == 0) return;
  const DramQueue& queue = queues_[planned_writes_];
  const auto eldest = static_cast<std::uint32_t>(queue.taken()) - (1u << (kOrderBits - 1));
  std::uint64_t first = ~std::uint64_t{0};
  const auto compare = [&](std::uint32_t bank, DramCycle at) {
    const std::uint64_t order = static_cast<std::uint32_t>(queue.line(bank).other_order) - eldest;
    first = std::min(first, static_cast<std::uint64_t>(at - from) << (kOrderBits + kBankBits) |
                                (order & 0xffffffffu) << kBankBits | bank);
  };
  const DramCycle precharge = std::max({from, buses_.row_free(), precharge_});
  for (std::uint64_t left = banks & open_; left != 0; left &= left - 1) {
    const auto bank = static_cast<std::uint32_t>(std::countr_zero(left));
    compare(bank, std::max(precharge, banks_[bank].precharge));
  }
  for (std::uint64_t left = half_ ? 0 : banks & ~open_; left != 0; left &= left - 1) {
    const auto bank = static_cast<std::uint32_t>(std::countr_zero(left));
    compare(bank, std::max({from, banks_[bank].activate, groups_[banks_[bank].group].gate}));
  }
  if (first == ~std::uint64_t{0}) return;
  const auto bank = static_cast<std::uint32_t>(first & kBankMask);
  const DramQueue::Line& line = queue.line(bank);
  row.at = from + static_cast<DramCycle>(first >> (kOrderBits + kBankBits));
  row.order = line.other_order;
  row.index = line.other;
  row.bank = bank;
}

/// A request that took a place now, if it is the oldest of its bank that wants what it wants.
void DramChannel::consider(std::uint32_t bank, DramCycle now) {
  const DramQueue& queue = queues_[planned_writes_];
  const std::uint64_t bit = std::uint64_t{1} << bank;
  if ((queue.hits() & bit) != 0) consider_column(bank, now);
  consider_row(bank, now);
}

void DramChannel::consider_row(std::uint32_t bank, DramCycle from) {
  const std::uint64_t bit = std::uint64_t{1} << bank;
  Plan row;
  first_row(queues_[planned_writes_].others() & ~activated_ & bit, from, row);
  if (row.at < row_.at || (row.at == row_.at && row.order < row_.order)) row_ = row;
}

}  // namespace carousel::ringbus::cycle
