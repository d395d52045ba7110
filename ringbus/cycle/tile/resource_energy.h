#pragma once

#include "core/statistics/shape_buffer_counts.h"
#include "ringbus/cycle/testers/tester.h"
#include "ringbus/cycle/tile/resource_agent.h"
#include "ringbus/packets/statistics_sink.h"

namespace carousel::ringbus::cycle {

/// Fills in what the units, the ray store, the collections and the shape buffer of a resource have done.
inline void read_energy(const Tester& tester, const ResourceStatistics& counts, const ShapeBufferCounts& shapes,
                        ResourceAgent::Work& work) {
  work.energy.tests = counts.tests;
  work.energy.record_reads = counts.reads + tester.second_reads();
  work.energy.packet_rays = counts.packet_rays;
  work.energy.shape_reads = shapes.hits + shapes.merged + shapes.misses;
  if (tester.distributor() != nullptr) work.distributor = &tester.distributor()->counts();
}

}  // namespace carousel::ringbus::cycle
