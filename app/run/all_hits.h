#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <mutex>
#include <unordered_map>
#include <vector>

#include "core/types/hit_sink.h"

namespace carousel::app {

/// All hits of a file's rays (`rays.query: all`), each once: nearest first, then by instance, primitive, u and v. The
/// hits of a traced ray are a set, so a ray that is traced again, by another run as well, adds nothing.
class AllHits final : public HitSink {
 public:
  /// A ray may have `most` hits.
  explicit AllHits(std::size_t most) : most_(most) {}

  /// Throws a SimulationError if the ray has more hits than it may.
  void add(std::uint32_t path, const Hit& hit) override;

  std::vector<Hit> of(std::uint32_t path) const;

 private:
  struct alignas(64) Shard {   // rays are spread over several, so that threads seldom wait for one another
    mutable std::mutex mutex;  // guards `hits`
    std::unordered_map<std::uint32_t, std::vector<Hit>> hits;  // by path, sorted
  };
  const std::size_t most_;
  std::array<Shard, 64> shards_;
};

}  // namespace carousel::app
