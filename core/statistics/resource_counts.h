#pragma once

#include "core/statistics/counters.h"

namespace carousel {

/// Packets and rays at one resource.
struct ResourceCounts {
  std::uint64_t rays_admitted = 0, rays_completed = 0;
  std::uint64_t packets_issued = 0, packets_retired = 0, visits = 0, bubbles = 0, hops = 0, local_rays = 0;
  std::uint64_t packet_rays = 0, seen_rays = 0, memberships = 0, reads = 0;

  static constexpr auto counters() {
    using C = ResourceCounts;
    return std::array{
        Counter{"rays_admitted", &C::rays_admitted, "IDs",
                "IDs of rays, or of bundles of rays, that joined the root collection"},
        Counter{"rays_completed", &C::rays_completed, "rays", "rays handed over to shading"},
        Counter{"packets_issued", &C::packets_issued, "packets", "packets issued from the resource's collections"},
        Counter{"packets_retired", &C::packets_retired, "packets", "packets of the resource that came back to it"},
        Counter{"packets_seen", &C::visits, "packets", "visits of packets, its own and others'"},
        Counter{"bubbles", &C::bubbles, "packets", "idle visits: visits of packets without a local ray"},
        Counter{"hops", &C::hops, "packets", "packets sent on to a neighbour"},
        Counter{"rays_tested", &C::local_rays, "rays", "members of packets that were tested here"},
        Counter{"packet_rays", &C::packet_rays, "rays", "members of issued packets", Shown::kNever},
        Counter{"seen_rays", &C::seen_rays, "rays", "members of all packets that visited", Shown::kNever},
        Counter{"memberships", &C::memberships, "ray IDs", "ray IDs that joined collections at retirement",
                Shown::kNever},
        Counter{"reads", &C::reads, "records", "records of rays and bundles read for tests", Shown::kNever},
    };
  }
  friend bool operator==(const ResourceCounts&, const ResourceCounts&) = default;
};

}  // namespace carousel
