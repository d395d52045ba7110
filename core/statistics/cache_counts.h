#pragma once

#include "core/statistics/counters.h"

namespace carousel {

/// Lines that a part asked a cache to fetch ahead of those who need them. CacheCounts has none of them but in the
/// cycles of its ports.
struct AheadCounts {
  std::uint64_t asked = 0, found = 0, fetched = 0, dropped = 0;

  static constexpr auto counters() {
    using C = AheadCounts;
    return std::array{
        Counter{"asked", &C::asked, "lines", "lines that the cache was asked to fetch ahead"},
        Counter{"found", &C::found, "lines", "those that were here, or on their way from memory"},
        Counter{"fetched", &C::fetched, "lines", "those that were fetched from memory"},
        Counter{"dropped", &C::dropped, "lines", "those for which their bank had no miss register (memory.l2_mshrs)"},
    };
  }
  friend bool operator==(const AheadCounts&, const AheadCounts&) = default;
};

/// Use of a cache of shape data.
struct CacheCounts {
  std::uint64_t requests = 0, lines = 0, hits = 0, merged = 0, misses = 0, written = 0, kept = 0, write_fetches = 0,
                written_back = 0, drained = 0, past_end = 0, past_end_misses = 0, pushed = 0, port_waits = 0,
                mshr_waits = 0, port_busy = 0, pages = 0, page_misses = 0, walks = 0, walk_reads = 0, page_waits = 0;

  static constexpr auto counters() {
    using C = CacheCounts;
    return std::array{
        Counter{"requests", &C::requests, "requests", "requests for lines"},
        Counter{"lines", &C::lines, "lines", "lines looked up"},
        Counter{"hits", &C::hits, "lines", "lines found"},
        Counter{"merged", &C::merged, "lines", "lines already on their way from memory"},
        Counter{"misses", &C::misses, "lines", "lines fetched from memory"},
        Counter{"written", &C::written, "lines",
                "lines written through to memory: spilled collection entries, and data of rays and paths"},
        Counter{"kept", &C::kept, "lines", "lines written that stay here until they are replaced"},
        Counter{"write_fetches", &C::write_fetches, "lines",
                "lines fetched from memory since a part of them was written"},
        Counter{"written_back", &C::written_back, "lines", "written lines that went to memory when they were replaced"},
        Counter{"drained", &C::drained, "lines", "written lines that went to memory when the run was over"},
        Counter{"past_end", &C::past_end, "lines", "lines looked up behind the end of a strip that ends by its flag"},
        Counter{"past_end_misses", &C::past_end_misses, "lines", "those of them that were fetched from memory"},
        Counter{"pushed", &C::pushed, "strips", "strips and transforms sent to resources that did not ask for them"},
        Counter{"port_waits", &C::port_waits, "lines", "lines for which the ports of their bank were not free at once"},
        Counter{"mshr_waits", &C::mshr_waits, "lines", "lines that waited until their bank could fetch another line"},
        Counter{"port_busy_cycles", &C::port_busy, "cycles", "cycles in which the ports looked up lines, of all banks"},
        Counter{"pages", &C::pages, "lines", "lines whose pages were looked up in its TLB (memory.translation)"},
        Counter{"page_misses", &C::page_misses, "lines", "lines of these whose pages were not there"},
        Counter{"walks", &C::walks, "pages", "pages for which its walker read the page table"},
        Counter{"walk_reads", &C::walk_reads, "lines", "lines that it read from memory for that, one a level"},
        Counter{"page_wait_cycles", &C::page_waits, "line-cycles", "time that lines waited for their pages"},
    };
  }
  friend bool operator==(const CacheCounts&, const CacheCounts&) = default;
};

}  // namespace carousel
