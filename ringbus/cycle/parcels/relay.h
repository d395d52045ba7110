#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "ringbus/cycle/parcels/door.h"
#include "ringbus/cycle/parcels/parcel_port.h"
#include "ringbus/cycle/parcels/parcel_routes.h"
#include "ringbus/time/agent.h"

namespace carousel::ringbus::cycle {

/// What a node of drawn links does for parcels: it takes in those of its parts, sends each on by the shortest way, and
/// hands out those that have come to their stop. It has room for all of them (parcel_plan.h), and the links decide how
/// long each waits.
class Relay final : public Agent {
 public:
  /// `in`: the far ends of the links that enter the node; `out`: the near ends of those that leave it, by port.
  /// `cycles`: what the node takes before a parcel leaves. Keeps a reference to the routes.
  Relay(std::uint32_t node, Cycle cycles, const ParcelRoutes& routes, std::vector<Channel<Parcel>*> in,
        std::vector<ParcelPort> out)
      : node_(node), cycles_(cycles), routes_(routes), in_(std::move(in)), out_(std::move(out)) {}

  /// While no agent runs.
  void put_door(std::uint32_t number, std::unique_ptr<Door> door);

  Cycle next() const override;
  bool polled() const override { return false; }
  void run(Cycle end) override;
  Cycle next_after_run() const override { return next_; }
  std::string describe() const override { return ""; }

  Cycle last_step() const { return last_step_; }

 private:
  void forward(Parcel&& parcel, Cycle now);

  std::uint32_t node_;
  Cycle cycles_;
  const ParcelRoutes& routes_;
  std::vector<Channel<Parcel>*> in_;
  std::vector<ParcelPort> out_;
  std::vector<std::unique_ptr<Door>> doors_;
  std::vector<Parcel> collected_;
  Cycle next_ = 0;  // next(), at the end of the last run()
  Cycle last_step_ = 0;
};

}  // namespace carousel::ringbus::cycle
