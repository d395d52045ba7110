#include "ringbus/native/native_router.h"

#include <algorithm>
#include <array>
#include <limits>

#include <fmt/format.h>

#include "ringbus/schedule/schedule.h"

namespace carousel::ringbus {

namespace {

constexpr std::size_t kRouterBatch = 8;  // packets that are moved at once: one index update for all

}  // namespace

NativeRouter::NativeRouter(ResourceId node, NativeMachine& machine, bool links_fail)
    : node_(node),
      topology_(machine.shared.topology),
      stops_(machine.stops),
      packets_(machine.shared.packets),
      links_fail_(links_fail),
      places_(topology_.hub_places(node.value - topology_.resources())) {
  if (places_ == 0) places_ = std::numeric_limits<std::size_t>::max();
  const Topology::Ports& ports = topology_.ports(node);
  for (const std::uint32_t wire : ports.in) in_ports_.push_back({machine.links[wire].get(), {}});
  for (const std::uint32_t wire : ports.out) out_ports_.push_back({machine.links[wire].get(), wire, {}});
}

void NativeRouter::record(NativeRecorder& recorder) {
  recorder_ = &recorder;
  recording_ = recorder.of_router(node_);
}

bool NativeRouter::step() {
  bool moved = false;
  for (std::size_t i = 0; links_fail_ && i < out_ports_.size(); ++i) moved |= out_ports_[i].link->tick();
  for (std::size_t i = 0; links_fail_ && i < in_ports_.size(); ++i) in_ports_[i].link->tick_receiver();
  moved |= send();
  schedule_point();
  moved |= take_in();
  schedule_point();
  return send() || moved;
}

bool NativeRouter::send() {
  bool moved = false;
  std::array<PacketId, kRouterBatch> batch;
  std::array<std::uint64_t, kRouterBatch> trips{};
  for (OutPort& out : out_ports_) {
    while (!out.egress.empty()) {
      const std::size_t count = std::min(batch.size(), out.egress.size());
      std::copy_n(out.egress.begin(), count, batch.begin());
      std::uint64_t at = 0;
      if (recorder_ != nullptr) [[unlikely]] {
        // A packet that has left may come home and be issued anew at once, so its trip is looked up before.
        for (std::size_t i = 0; i < count; ++i) trips[i] = recording_.trips->of(batch[i].value);
        at = recorder_->now();
      }
      const std::size_t sent = out.link->try_send({batch.data(), count});
      if (recorder_ != nullptr && sent > 0) [[unlikely]] {
        const std::uint64_t each = (recorder_->now() - at) / sent;
        for (std::size_t i = 0; i < sent; ++i, at += each)
          recording_.slices->add(
              {at, at + each, trips[i], 0, recorder_->link_track(out.wire), batch[i].value, 0, SliceKind::kLink});
      }
      out.egress.erase(out.egress.begin(), out.egress.begin() + static_cast<std::ptrdiff_t>(sent));
      moved |= sent > 0;
      if (sent < count) break;
    }
  }
  return moved;
}

bool NativeRouter::take_in() {
  bool moved = false, waits = false;
  std::array<PacketId, kRouterBatch> batch;
  for (std::size_t i = 0; i < in_ports_.size(); ++i) {
    InPort& in = in_ports_[(turn_ + i) % in_ports_.size()];
    if (in.waiting.empty()) {
      const std::size_t count =
          in.link->try_receive(std::span(batch).first(std::min(kRouterBatch, in.link->capacity())));
      in.waiting.assign(batch.begin(), batch.begin() + static_cast<std::ptrdiff_t>(count));
    }
    moved |= pass_on(in);
    waits |= !in.waiting.empty();
  }
  if (waits) turn_ = (turn_ + 1) % in_ports_.size();  // the next time, another link is the first
  return moved;
}

/// Puts packets that wait at the end of a link into egress queues, until one finds no place.
bool NativeRouter::pass_on(InPort& in) {
  bool moved = false;
  while (!in.waiting.empty()) {
    const PacketId id = in.waiting.front();
    OutPort& out = out_ports_[topology_.exit(node_, stops_[id.value], packets_[id.value].direction).port];
    if (out.egress.size() >= places_) break;
    in.waiting.pop_front();
    out.egress.push_back(id);
    moved = true;
  }
  return moved;
}

bool NativeRouter::empty() const {
  return std::all_of(in_ports_.begin(), in_ports_.end(), [](const InPort& in) { return in.waiting.empty(); }) &&
         std::all_of(out_ports_.begin(), out_ports_.end(), [](const OutPort& out) { return out.egress.empty(); });
}

std::string NativeRouter::describe() const {
  if (empty()) return "";
  std::size_t leaving = 0, waiting = 0;
  for (const OutPort& out : out_ports_) leaving += out.egress.size();
  for (const InPort& in : in_ports_) waiting += in.waiting.size();
  return fmt::format("router {}: {} packets wait to leave, and {} for a place here",
                     node_.value - topology_.resources(), leaving, waiting);
}

}  // namespace carousel::ringbus
