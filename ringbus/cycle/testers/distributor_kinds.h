#pragma once

#include <cstdint>
#include <vector>

#include "core/config/fields/collections.h"
#include "core/config/fields/testers.h"
#include "core/statistics/distributor_counts.h"
#include "ringbus/time/channel_list.h"

namespace carousel::ringbus::cycle {

/// The wires between a distributor, its testers and the decision point, which lie within one agent. A result names the
/// ray, and has a mask of the shapes that it hits, or with ordered traversal the next node.
class DistributorKinds {
 public:
  /// `link_width` in bytes a cycle, as wide as the bus of shapes.
  DistributorKinds(ChannelList& list, const TestersConfig::Distributor& of, Traversal traversal,
                   std::uint64_t link_width)
      : result_bytes_(kId + (traversal == Traversal::kOrdered ? kNext : kMask)),
        ids_(list.carry(
            {"ray IDs", "distributor", "testers", "wires of IDs", kId * static_cast<std::uint64_t>(of.ids_per_cycle)})),
        shapes_(list.carry({"shapes", "distributor", "testers", "bus of shapes", link_width})),
        results_(list.carry({"results", "testers", "decision point", "wires of results",
                             result_bytes_ * static_cast<std::uint64_t>(of.results_per_cycle)})) {}

  void count(std::vector<ByteRow>& rows, const DistributorCounts& counts) const {
    ByteRow& ids = rows[ChannelList::index(ids_)];
    ByteRow& shapes = rows[ChannelList::index(shapes_)];
    ByteRow& results = rows[ChannelList::index(results_)];
    ids.messages = results.messages = counts.ids;
    ids.bytes = kId * counts.ids;
    ids.bytes_taken = kId * counts.results;
    shapes.messages = counts.packets;
    shapes.bytes = counts.shape_bytes;
    shapes.bytes_taken = counts.shapes_taken;
    results.bytes = result_bytes_ * counts.ids;
    results.bytes_taken = result_bytes_ * counts.results;
  }

 private:
  static constexpr std::uint64_t kId = 4, kMask = 1, kNext = 12;
  std::uint64_t result_bytes_;
  MessageKind ids_, shapes_, results_;
};

}  // namespace carousel::ringbus::cycle
