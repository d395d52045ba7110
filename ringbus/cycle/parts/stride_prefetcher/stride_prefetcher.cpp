#include "ringbus/cycle/parts/stride_prefetcher/stride_prefetcher.h"

#include <cstdlib>

#include "ringbus/cycle/messages/side_ports.h"
#include "ringbus/cycle/shapes/shape_cache.h"

namespace carousel::ringbus::cycle {

StridePrefetcher::Kinds::Kinds(ChannelList& list, const LinkConfig& link)
    : hints(list.carry({"prefetch hints", "resources", StridePrefetcherPart::kName, "wires of hints",
                        static_cast<std::uint64_t>(link.bytes_per_cycle)})),
      requests(list.carry({"prefetch requests", StridePrefetcherPart::kName, "L2", "request wires",
                           static_cast<std::uint64_t>(link.bytes_per_cycle)})) {}

StridePrefetcher::StridePrefetcher(const StridePrefetcherKeys& keys, const Kinds& kinds, const PartSites& sites,
                                   const PartSite& site)
    : ahead_(keys.lines),
      reach_(keys.reach),
      requests_(std::make_unique<Channel<FetchRequest>>(
          sites.list.at(kinds.requests, {site.agent, site.l2, control_latency(sites.link)}))),
      wire_(sites.link, control_latency(sites.link)),
      streams_(static_cast<std::size_t>(keys.streams)) {
  for (const std::uint32_t resource : site.resources)
    hints_.push_back(std::make_unique<Channel<ShapeHint>>(
        sites.list.at(kinds.hints, {resource, site.agent, ShapeCache::request_latency(sites.memory)})));
}

AttachedPart<StridePrefetcherCounts> StridePrefetcher::ends() const {
  AttachedPart<StridePrefetcherCounts> out;
  for (const auto& channel : hints_) out.hints.push_back(channel.get());
  out.ahead = requests_.get();
  return out;
}

Cycle StridePrefetcher::next() const {
  Cycle first = kNever;
  for (const auto& channel : hints_) first = std::min(first, channel->next());
  return first;
}

/// Hints of one cycle are taken in the order of their resources.
void StridePrefetcher::run(Cycle end) {
  for (Cycle now; (now = next()) < end;)
    for (const auto& channel : hints_)
      while (channel->next() <= now) take(channel->take(), now);
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
  FetchRequest request{static_cast<std::uint64_t>(line), 1};
  request.ahead = true;
  requests_->send(wire_.send(request.bytes(), now), request);
  ++counts_.lines;
}

std::vector<AttachedPart<StridePrefetcherCounts>> attach(const StridePrefetcherKeys& keys, const PartSites& sites) {
  const StridePrefetcher::Kinds kinds(sites.list, sites.link);
  std::vector<AttachedPart<StridePrefetcherCounts>> out;
  for (const PartSite& site : sites.at) {
    auto agent = std::make_unique<StridePrefetcher>(keys, kinds, sites, site);
    out.push_back(agent->ends());
    out.back().agent = std::move(agent);
  }
  return out;
}

}  // namespace carousel::ringbus::cycle
