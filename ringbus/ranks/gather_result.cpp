#include "ringbus/ranks/gather_result.h"

#include <algorithm>
#include <cstring>
#include <string>
#include <vector>

#include "core/system/error.h"
#include "ringbus/packets/word_stream.h"

namespace carousel::ringbus {

namespace {

template <class Visitor, class Statistics>
void visit_resource(Visitor& visitor, Statistics& s) {
  if constexpr (std::is_const_v<Statistics>)
    visitor.part(static_cast<const ResourceCounts&>(s));
  else
    visitor.part(static_cast<ResourceCounts&>(s));
  visitor.part(s.stalls);
  visitor.part(s.tests);
  visitor.part(s.bundles);
  visitor.part(s.nodes);
  visitor.part(s.culls);
}

/// The parts that all ranks add up, in their order on the wire.
template <class Visitor, class SomeResult>
void visit_sums(Visitor& visitor, SomeResult& result) {
  visitor.part(result.complete);
  visitor.part(result.rays_emitted);
  visitor.part(result.rays_completed);
  visitor.part(result.slots_used);
  visitor.part(result.slot_waits);
  visitor.part(result.completed);
  visitor.part(result.groups);
}

std::string pack(const RankShare& share, const RunResult& result) {
  std::vector<std::uint64_t> words;
  WordWriter writer(words);
  visit_sums(writer, result);
  writer.part(result.threads);
  writer.part(std::uint64_t{!result.resources.empty()});
  for (std::uint32_t r = share.arc_begin(); r < share.arc_end(); ++r) {
    if (!result.resources.empty()) visit_resource(writer, result.resources[r]);
    writer.part(result.collections[r]);
  }
  for (const LinkResult& link : result.links) writer.part(link.statistics);
  writer.part(result.ranks.at(share.rank()).memory);
  writer.part(result.ranks.at(share.rank()).to);
  writer.part(result.ranks.at(share.rank()).waiting);
  return {reinterpret_cast<const char*>(words.data()), words.size() * sizeof words[0]};
}

void add_link(const LinkStatistics& other, LinkStatistics& sum) {
  sum.packets += other.packets;
  sum.refusals += other.refusals;
  sum.batches += other.batches;
  sum.full_stalls += other.full_stalls;
  sum.occupancy_max = std::max(sum.occupancy_max, other.occupancy_max);
  sum.occupancy_sum += other.occupancy_sum;
  sum.samples += other.samples;
  sum.receives += other.receives;
  sum.empty_stalls += other.empty_stalls;
}

void unpack(const std::string& bytes, std::uint32_t rank, const RankShare& share, RunResult& result) {
  std::vector<std::uint64_t> words(bytes.size() / sizeof(std::uint64_t));
  std::memcpy(words.data(), bytes.data(), words.size() * sizeof words[0]);
  WordReader reader(words);
  RunResult sums;
  visit_sums(reader, sums);
  RankResult& own = result.ranks.at(rank);
  own.first_resource = share.arc_begin(rank);
  own.resources = share.arc_begin(rank + 1) - own.first_resource;
  own.rays_completed = sums.rays_completed;
  reader.part(own.threads);
  std::uint64_t counted = 0;
  reader.part(counted);
  for (std::uint32_t r = own.first_resource; r < own.first_resource + own.resources; ++r) {
    if (counted != 0) visit_resource(reader, result.resources.at(r));
    reader.part(result.collections.at(r));
  }
  LinkStatistics link;
  for (LinkResult& sum : result.links) {
    reader.part(link);
    if (rank != share.rank()) add_link(link, sum.statistics);
  }
  reader.part(own.memory);
  reader.part(own.to);
  reader.part(own.waiting);
  if (rank == share.rank()) return;
  result.complete &= sums.complete;
  result.rays_emitted += sums.rays_emitted;
  result.rays_completed += sums.rays_completed;
  result.slots_used += sums.slots_used;
  result.slot_waits += sums.slot_waits;
  result.completed += sums.completed;
  result.groups += sums.groups;
  result.threads += own.threads;
}

}  // namespace

void gather_result(Transport& transport, const RankShare& share, RunResult& result) {
  const std::vector<std::string> all = transport.gather(pack(share, result));
  for (std::uint32_t rank = 0; rank < all.size(); ++rank) unpack(all[rank], rank, share, result);
}

}  // namespace carousel::ringbus
