#include "app/run/all_hits.h"

#include <algorithm>
#include <tuple>

#include <fmt/format.h>

#include "core/system/error.h"

namespace carousel::app {

namespace {

bool before(const Hit& a, const Hit& b) {
  return std::tuple(a.t, a.instance, a.primitive, a.u, a.v) < std::tuple(b.t, b.instance, b.primitive, b.u, b.v);
}

}  // namespace

void AllHits::add(std::uint32_t path, const Hit& hit) {
  Shard& shard = shards_[path % shards_.size()];
  const std::lock_guard lock(shard.mutex);
  std::vector<Hit>& hits = shard.hits[path];
  const auto at = std::lower_bound(hits.begin(), hits.end(), hit, before);
  if (at != hits.end() && !before(hit, *at)) return;
  if (hits.size() == most_)
    throw ConfigError("rays.hits_per_ray",
                      fmt::format("a ray of the file has more than {} hits; expected a larger number", most_));
  hits.insert(at, hit);
}

std::vector<Hit> AllHits::of(std::uint32_t path) const {
  const Shard& shard = shards_[path % shards_.size()];
  const std::lock_guard lock(shard.mutex);
  const auto found = shard.hits.find(path);
  return found == shard.hits.end() ? std::vector<Hit>{} : found->second;
}

}  // namespace carousel::app
