#include "ringbus/cycle/parts/stride_prefetcher/stride_prefetcher.h"

#include <cstdlib>
#include <memory>
#include <utility>

#include "ringbus/cycle/parts/stride_prefetcher/own_prefetcher.h"

namespace carousel::ringbus::cycle {

StridePrefetcher::StridePrefetcher(const StridePrefetcherKeys& keys, PrefetcherPorts ports)
    : ahead_(keys.lines),
      reach_(keys.reach),
      ports_(std::move(ports)),
      streams_(static_cast<std::size_t>(keys.streams)) {}

void StridePrefetcher::run(Cycle end) {
  for (Cycle now; (now = next()) < end;)
    ports_.take_until(now, [&](const ShapeHint& hint, std::size_t) { take(hint, now); });
}

void StridePrefetcher::take(const ShapeHint& hint, Cycle now) {
  ++counts_.hints;
  const auto line = static_cast<std::int64_t>(hint.first_line);
  for (Stream& stream : streams_)
    if (stream.begun && std::abs(line - stream.last) <= reach_) return follow(stream, line, now);
  streams_[oldest_] = {line, 0, 0, true};
  oldest_ = (oldest_ + 1) % streams_.size();
  ++counts_.streams;
}

void StridePrefetcher::follow(Stream& stream, std::int64_t line, Cycle now) {
  const std::int64_t step = line - stream.last;
  if (step == 0) return;
  const bool follows = step == stream.stride;
  if (follows && stream.asked > 0) {
    ++counts_.met;
    --stream.asked;
  } else {
    stream.asked = 0;
  }
  stream.last = line;
  stream.stride = step;
  if (!follows) return;
  ++counts_.followed;
  for (; stream.asked < ahead_; ++stream.asked) ask(line + (stream.asked + 1) * step, now);
}

void StridePrefetcher::ask(std::int64_t line, Cycle now) {
  if (line < 0) return;
  ports_.ask(static_cast<std::uint64_t>(line), now);
  ++counts_.lines;
}

std::vector<AttachedPart<StridePrefetcherCounts>> attach(const StridePrefetcherKeys& keys, const PartSites& sites) {
  const PrefetcherPorts::Kinds kinds(sites.list, sites.link);
  std::vector<AttachedPart<StridePrefetcherCounts>> out;
  for (const PartSite& site : sites.at) {
    PrefetcherPorts ports(kinds, sites, site);
    out.push_back(ports.ends());
    if (keys.own() != nullptr)
      out.back().agent = std::make_unique<OwnPrefetcher>(keys, std::move(ports));
    else
      out.back().agent = std::make_unique<StridePrefetcher>(keys, std::move(ports));
  }
  return out;
}

}  // namespace carousel::ringbus::cycle
