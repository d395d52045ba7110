#pragma once

#include <algorithm>
#include <memory>
#include <span>
#include <vector>

#include "ringbus/cycle/fabric/port_counters.h"
#include "ringbus/cycle/fabric/ports.h"
#include "ringbus/packets/packet.h"
#include "ringbus/results/counter_samples.h"
#include "ringbus/time/agent.h"
#include "ringbus/topology/topology.h"

namespace carousel::ringbus::cycle {

/// A node of the network that is no resource.
class Hub : public Agent {
 public:
  Hub(std::vector<InPort> in, std::vector<OutPort> out) : in_(std::move(in)), out_(std::move(out)) {}
  /// The near ends of its links, by port.
  const std::vector<OutPort>& out() const { return out_; }
  /// From now on the counters of its links are read over time, at most so often (resource_samples.h).
  void sample(std::size_t most) { samples_ = CounterSamples(most, counter_index(PortCounter::kBusy, out_.size(), 0)); }
  void record(std::size_t port, const LinkRecorder& recorder) { out_[port].record(recorder); }
  /// Its cycles, and those of the resources, in which its counters are read. Before the start.
  void tell_time(const ClockRatio& from_core) { from_core_ = from_core; }
  /// `end` by the clock of the resources.
  void close(Cycle end) {
    samples_.close(end, [this](Cycle at, std::span<std::uint64_t> row) { read(at, row); });
  }
  const CounterSamples& samples() const { return samples_; }

 protected:
  /// To be called before anything happens at `now`.
  void look_at(Cycle now) {
    if (!from_core_.equal()) [[unlikely]]
      now = from_core_.before(now);
    if (samples_.due(now)) [[unlikely]]
      samples_.until(now, [this](Cycle at, std::span<std::uint64_t> row) { read(at, row); });
  }

  std::vector<InPort> in_;
  std::vector<OutPort> out_;

 private:
  /// At a cycle of the resources, as these count.
  void read(Cycle at, std::span<std::uint64_t> row) const {
    if (from_core_.equal()) return read_ports(out_, at, 0, row);
    const Cycle edge = from_core_.floor_to_network(at);
    read_ports(out_, edge, 0, row);
    for (std::size_t i = 0; i < out_.size(); ++i) {
      std::uint64_t& busy = row[counter_index(PortCounter::kBusy, i, 0)];
      busy = from_core_.part_before(busy, out_[i].busy(edge + 1) > busy, at);
    }
  }

  ClockRatio from_core_;
  CounterSamples samples_;
};

/// The topology's hub number `hub`, with its ports. Keeps references to the topology and the packets.
std::unique_ptr<Hub> make_hub(std::uint32_t hub, const Topology& topology, std::span<const Packet> packets,
                              std::vector<InPort> in, std::vector<OutPort> out);

}  // namespace carousel::ringbus::cycle
