#include "ringbus/cycle/parts/stride_prefetcher/own_prefetcher.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "core/system/error.h"

namespace carousel::ringbus::cycle {

namespace {

constexpr std::uint64_t kLineLimit = std::uint64_t{1} << 48;

}  // namespace

OwnPrefetcher::OwnPrefetcher(const StridePrefetcherKeys& keys, PrefetcherPorts ports)
    : keys_(keys),
      ports_(std::move(ports)),
      rule_(keys.own()->make(keys.setup(static_cast<std::uint32_t>(ports_.resources())))) {
  if (rule_ == nullptr) fail("makes none");
}

Cycle OwnPrefetcher::next() const {
  return std::min(ports_.next(), rule_->next());
}

void OwnPrefetcher::run(Cycle end) {
  for (Cycle now; (now = next()) < end;) {
    if (now < now_ || (now == now_ && rule_->next() == now && ports_.next() > now))
      fail(fmt::format("wants cycle {} when cycle {} is over", now, now_));
    now_ = now;
    ports_.take_until(now, [&](const ShapeHint& hint, std::size_t place) {
      ++counts_.hints;
      counts_.met += asked_.erase(hint.first_line);
      begin_call();
      rule_->hear(hint.first_line, static_cast<std::uint32_t>(place), now, *this);
      if (asked_now_ > 0) ++counts_.followed;
    });
    if (rule_->next() > now) continue;
    begin_call();
    rule_->step(now, *this);
  }
}

void OwnPrefetcher::ask(std::uint64_t line) {
  if (++asked_now_ > keys_.lines) fail(fmt::format("asks for more than prefetcher.lines, {}, at once", keys_.lines));
  if (line >= kLineLimit) fail(fmt::format("asks for line {}, which no memory has", line));
  ports_.ask(line, now_);
  asked_.insert(line);
  ++counts_.lines;
}

void OwnPrefetcher::fail(const std::string& what) const {
  throw SimulationError(fmt::format("prefetcher.rule: {} {}", enum_name(keys_.rule), what));
}

}  // namespace carousel::ringbus::cycle
