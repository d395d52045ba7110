#pragma once

#include <cstdint>
#include <vector>

#include "ringbus/cycle/parcels/door.h"
#include "ringbus/cycle/parcels/line_turns.h"
#include "ringbus/cycle/shapes/cache/cache_clients.h"
#include "ringbus/cycle/shapes/cache/index_pool.h"

namespace carousel::ringbus::cycle {

/// A resource's way to its caches. A request for lines of several caches goes to each of them for its own, and the
/// answer is whole when the last part has come.
class FetchDoor final : public Door {
 public:
  /// `banks`: the doors at the caches, as many as `turns` has nodes. Keeps the client's channels.
  FetchDoor(const CacheClient& client, const LineTurns& turns, std::vector<DoorPlace> banks, std::uint64_t line_bytes)
      : client_(client), turns_(turns), banks_(std::move(banks)), line_bytes_(line_bytes), parts_(banks_.size()) {}

  Cycle next() const override { return client_.requests->next(); }
  void collect(Cycle now, std::vector<Parcel>& out) override;
  void deliver(Parcel&& parcel, Cycle now) override;

 private:
  struct Waiting {
    std::uint32_t tag = 0, parts = 0, size = 0;
  };
  void split(const FetchRequest& request, std::vector<Parcel>& out);

  CacheClient client_;
  LineTurns turns_;
  std::vector<DoorPlace> banks_;
  std::uint64_t line_bytes_;
  std::vector<FetchRequest> parts_;  // by bank, of the request that is being split
  IndexPool<Waiting> waiting_;       // the tag of a part is its index here
};

/// A cache's way to a resource that asks it.
class CacheDoor final : public Door {
 public:
  /// `client`: the near ends of the cache's channels. `asker`: the resource's door.
  CacheDoor(const CacheClient& client, DoorPlace asker) : client_(client), asker_(asker) {}

  Cycle next() const override { return client_.answers->next(); }
  void collect(Cycle now, std::vector<Parcel>& out) override;
  void deliver(Parcel&& parcel, Cycle now) override;

 private:
  CacheClient client_;
  DoorPlace asker_;
};

}  // namespace carousel::ringbus::cycle
