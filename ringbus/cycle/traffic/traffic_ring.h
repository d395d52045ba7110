#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <utility>
#include <vector>

#include "ringbus/cycle/rings/ring_docks.h"
#include "ringbus/cycle/traffic/traffic_agent.h"

namespace carousel::ringbus::cycle {

/// A ring whose stops have no queues among the nodes of a graph without rays. Nothing is created or delivered there.
class TrafficRing final : public TrafficAgent {
 public:
  /// `node`: its number. `in` and `out`: the ports of its wires. Keeps a reference to the topology.
  TrafficRing(ResourceId node, const TopologyConfig& config, const Topology& topology,
              const TrafficNodeSettings& settings, TrafficWindow window, std::vector<In> in, std::vector<Out> out)
      : TrafficAgent(settings, window),
        number_(node.value - topology.resources()),
        in_(std::move(in)),
        out_(std::move(out)),
        docks_(node, config, topology, in_, out_, marks_, settings.packet_bytes),
        busy_(out_.size()) {}

  Cycle next() const override { return docks_.next(now_); }
  void run(Cycle end) override {
    for (Cycle now; (now = next()) < end;) {
      for (; marks_passed_ < 2 && mark(marks_passed_) <= now; ++marks_passed_)
        for (std::size_t port = 0; port < out_.size(); ++port)
          busy_[port][marks_passed_] = out_[port].moved(mark(marks_passed_));
      now_ = now;
      docks_.step(now);
    }
  }
  std::string describe() const override { return docks_.describe(number_); }

  TrafficOffered offered() const override { return {}; }
  Moved moved(std::size_t port) const override {
    return {out_[port].packets(), out_[port].moved(), out_[port].stalled()};
  }
  Cycle busy_in_window(std::size_t port) const override {
    const auto before = [&](std::size_t i) { return i < marks_passed_ ? busy_[port][i] : out_[port].moved(mark(i)); };
    return std::min(before(1) - before(0), mark(1) - mark(0));  // ports count a packet when its last flit has come
  }

  const RingDocks<TrafficToken>& docks() const { return docks_; }

 private:
  std::size_t number_;  // behind the resources
  std::vector<In> in_;
  std::vector<Out> out_;
  RingDocks<TrafficToken> docks_;
  std::vector<std::array<Cycle, 2>> busy_;  // of the ports, before the marks that are passed
  std::size_t marks_passed_ = 0;
  Cycle now_ = 0;
};

}  // namespace carousel::ringbus::cycle
