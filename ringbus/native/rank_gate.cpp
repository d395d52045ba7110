#include "ringbus/native/rank_gate.h"

#include <algorithm>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "core/system/error.h"

namespace carousel::ringbus {

RankGate::RankGate(const Config& config, Transport& transport, Machine& machine, CompletedQueue& completed)
    : transport_(transport),
      machine_(machine),
      rank_(machine.share.rank()),
      depth_(static_cast<std::size_t>(config.topology.link.depth)),
      links_(machine.topology.wires().size(), nullptr),
      results_(machine, completed),
      end_(machine.share.rank(), machine.share.ranks()) {
  for (std::uint32_t r = 0; r < machine.share.ranks(); ++r) peers_.push_back(std::make_unique<Peer>());
  if (machine.accel.partition) shapes_.emplace(config, machine);
  machine_.control.place_by(*this);
}

std::unique_ptr<Link> RankGate::make_link(std::uint32_t wire, std::size_t depth) {
  const Topology::Wire& ends = machine_.topology.wires()[wire];
  const std::uint32_t from = machine_.share.rank_of(ends.from), to = machine_.share.rank_of(ends.to);
  RankLink::Send send;
  if (from == rank_) {
    send = [this, wire, at = ends.to, &peer = *peers_[to]](std::span<const PacketId> packets) {
      const std::lock_guard lock(peer.mutex);
      for (const PacketId id : packets) {
        peer.next.add(wire, id, machine_.packet(id));
        if (recorder_ != nullptr) peer.next.trips.push_back(recorder_->trip(id));
        if (shapes_) shapes_->take_along(id, machine_.packet(id), at, peer.next);
      }
    };
  }
  auto link = std::make_unique<RankLink>(ends.from, ends.to, depth, std::move(send));
  if (to == rank_) {
    peers_[from]->in_wires.push_back(wire);
    peers_[from]->credits_told.push_back(0);
  }
  links_[wire] = link.get();
  return link;
}

void RankGate::load(ResourceId resource, std::span<const RayId> ids, std::span<const RayRequest> rays) {
  if (rays.empty()) return;
  Peer& peer = *peers_[machine_.share.rank_of(resource)];
  const std::lock_guard lock(peer.mutex);
  for (std::size_t i = 0; i < rays.size(); ++i) peer.next.rays.push_back({ids[i], rays[i]});
  peer.rays_sent += rays.size();
  peer.held = true;
}

void RankGate::hold(ResourceId issuer, RayGroup&& group) {
  HeldGroups::Needs needs;
  for (std::uint32_t r = 0; r < peers_.size(); ++r) {
    const std::lock_guard lock(peers_[r]->mutex);
    if (std::exchange(peers_[r]->held, false)) needs.emplace_back(r, peers_[r]->rays_sent);
  }
  if (needs.empty() && machine_.control.deliver(issuer, group)) return;
  held_.add(issuer, std::move(group), std::move(needs));
}

void RankGate::send_results(ResourceId resource, HitBatch& done, std::vector<std::uint32_t>& slots) {
  std::size_t kept = 0;
  std::unique_lock<std::mutex> lock;
  std::uint32_t locked = rank_;  // the rank whose messages are, which takes a lock for rays in a row
  for (std::size_t i = 0; i < done.size(); ++i) {
    const std::uint32_t lessee = machine_.control.lessee(resource, slots[i]);
    if (lessee == rank_) {
      done[kept] = done[i];
      slots[kept++] = slots[i];
      continue;
    }
    if (locked != lessee) {
      if (lock.owns_lock()) lock.unlock();
      lock = std::unique_lock(peers_[lessee]->mutex);
      locked = lessee;
    }
    peers_[lessee]->next.results.push_back({resource, slots[i], done[i]});
  }
  done.resize(kept);
  slots.resize(kept);
}

void RankGate::start() {
  for (const auto& peer : peers_) peer->heard = peer->said = Clock::now();
}

bool RankGate::step(bool at_rest) {
  bool moved = receive();
  if (ended()) return moved;
  moved |= deliver_held();
  results_.hand_over();
  pass_token(at_rest);
  const bool idle = idle_.load(std::memory_order_relaxed);
  if (idle) idle_.store(false, std::memory_order_relaxed);
  for (std::uint32_t r = 0; r < peers_.size(); ++r)
    if (r != rank_) moved |= send(r, idle);
  return moved;
}

/// The token goes on when what this rank sent before has been counted: all that waits in `next` must leave first.
void RankGate::pass_token(bool at_rest) {
  if (token_ || !at_rest) return;
  for (const auto& peer : peers_) {
    const std::lock_guard lock(peer->mutex);
    if (peer->next.items() > 0) return;
  }
  token_ = end_.pass(true);
  if (end_.ended()) ended_.store(true, std::memory_order_release);
}

/// Sends a rank what there is for it, unless earlier messages have not left yet.
bool RankGate::send(std::uint32_t rank, bool idle) {
  Peer& peer = *peers_[rank];
  const bool has_token = token_ && rank == (rank_ + 1) % peers_.size();
  peer.idled |= idle;
  bool news = has_token || peer.rays_received != peer.rays_told || (idle && !peer.told_hungry);
  bool soon = idle || peer.hungry || has_token;
  for (std::size_t i = 0; i < peer.in_wires.size(); ++i) {
    const std::uint64_t taken = links_[peer.in_wires[i]]->taken();
    if (taken == peer.credits_told[i]) continue;
    soon |= (taken - peer.credits_told[i]) * kDepthShare >= depth_;
    sending_.credits.push_back({peer.in_wires[i], taken});
    news = true;
  }
  const Clock::time_point now = Clock::now();
  const bool sign = now - peer.said > kSign;
  std::size_t items = 0;
  {
    const std::lock_guard lock(peer.mutex);
    items = peer.next.items();
    soon |= peer.next.packets.size() * kDepthShare >= depth_;
  }
  bool anything = items >= kFull || ((news || sign || items > 0) && now - peer.said >= (soon ? kSoon : kWindow));
  if (anything && transport_.leaving(rank) >= kLeaving) {
    ++peer.counts.holds;
    if (!peer.held_since) peer.held_since = now;
    anything = false;
  }
  if (!anything) {
    sending_.clear();
    return false;
  }
  if (peer.held_since)
    peer.counts.hold_ns += static_cast<std::uint64_t>(std::chrono::nanoseconds(now - *peer.held_since).count());
  peer.held_since.reset();
  for (const LinkCredit& credit : sending_.credits) {
    const auto at = std::find(peer.in_wires.begin(), peer.in_wires.end(), credit.wire);
    peer.credits_told[static_cast<std::size_t>(at - peer.in_wires.begin())] = credit.taken;
  }
  {
    const std::lock_guard lock(peer.mutex);
    sending_.rays.swap(peer.next.rays);
    sending_.results.swap(peer.next.results);
    sending_.packets.swap(peer.next.packets);
    sending_.trips.swap(peer.next.trips);
    sending_.images.swap(peer.next.images);
    sending_.guests.swap(peer.next.guests);
    sending_.shapes.swap(peer.next.shapes);
  }
  if (has_token) sending_.token = std::exchange(token_, std::nullopt);
  const bool moved = sending_.items() > 0;
  if (!moved && !news) ++peer.counts.heartbeats;
  send_now(rank, sending_);
  return moved;
}

void RankGate::send_now(std::uint32_t rank, RankMessage& message) {
  Peer& peer = *peers_[rank];
  const std::uint64_t begin = recorder_ != nullptr ? recorder_->now() : 0;
  message.rays_taken = peer.rays_told = peer.rays_received;
  message.hungry = peer.told_hungry = std::exchange(peer.idled, false);
  end_.sent(message.items());
  message.write(words_);
  ++peer.counts.messages;
  peer.counts.bytes += words_.size() * sizeof words_[0];
  peer.counts.packets += message.packets.size();
  peer.counts.rays += message.rays.size();
  peer.counts.results += message.results.size();
  peer.counts.shapes += message.guests.size();
  peer.counts.shape_bytes += message.shapes.size() * sizeof message.shapes[0];
  transport_.send(rank, words_);
  if (recorder_ != nullptr)
    recorder_->note_message({rank_, rank}, SliceKind::kSend, peer.counts.messages, message.packets.size(), begin);
  peer.said = Clock::now();
  message.clear();
}

bool RankGate::next_message(std::uint32_t& from) {
  if (!transport_.receive(from, words_)) return false;
  received_.read(words_);
  ++peers_[from]->messages_received;
  return true;
}

void RankGate::note_received(std::uint32_t from, std::uint64_t begin) {
  if (recorder_ != nullptr)
    recorder_->note_message({from, rank_}, SliceKind::kReceive, peers_[from]->messages_received,
                            received_.packets.size(), begin);
}

bool RankGate::receive() {
  bool moved = false;
  std::uint32_t from = 0;
  while (!ended() && next_message(from)) {
    const std::uint64_t begin = recorder_ != nullptr ? recorder_->now() : 0;
    peers_[from]->heard = Clock::now();
    moved |= received_.items() > 0;
    take(from, received_);
    note_received(from, begin);
  }
  const Clock::time_point now = Clock::now();
  for (std::uint32_t r = 0; r < peers_.size(); ++r)
    if (r != rank_ && !ended() && now - peers_[r]->heard > kRankSilence)
      throw SimulationError(
          fmt::format("rank {} has said nothing for {} seconds; it hangs or has died", r, kRankSilence.count()));
  return moved;
}

void RankGate::take(std::uint32_t from, const RankMessage& message) {
  Peer& peer = *peers_[from];
  end_.received(message.items());
  for (const LinkCredit& credit : message.credits) links_.at(credit.wire)->credit(credit.taken);
  for (const RayOnWire& ray : message.rays) {
    const RayIdLayout& layout = machine_.stores[0]->layout();
    machine_.stores.at(layout.owner(ray.id).value)->load_leased(ray.id, ray.request, machine_.control.initial_tests());
  }
  peer.rays_received += message.rays.size();
  peer.rays_taken = message.rays_taken;
  peer.hungry = message.hungry;
  results_.take(message.results);
  for (std::size_t i = 0; i < message.guests.size(); ++i)
    if (shapes_) shapes_->enter(message.guests[i].packet, message.shapes_of(i));
  for (std::size_t i = 0; i < message.packets.size(); ++i) {
    const PacketOnWire& at = message.packets[i];
    message.restore_packet(i, machine_.packet(at.packet));
    if (recorder_ != nullptr && !message.trips.empty()) recorder_->bring(at.packet, message.trips[i]);
    links_.at(at.wire)->arrive(at.packet);
  }
  if (message.token) end_.take(*message.token);
  if (!message.farewell) return;
  peer.parted = true;
  if (message.farewell->reason == Farewell::Reason::kFault) {
    cause_ = message.farewell->text;
    throw SimulationError("the run was ended by " + cause_);
  }
  stopped_ |= message.farewell->reason == Farewell::Reason::kStop;
  ended_.store(true, std::memory_order_release);
}

bool RankGate::deliver_held() {
  return held_.deliver([this](std::uint32_t rank) { return peers_[rank]->rays_taken; },
                       [this](ResourceId issuer, RayGroup& group) { return machine_.control.deliver(issuer, group); });
}

void RankGate::part(const std::exception_ptr& error, const std::string& stuck) {
  using enum Farewell::Reason;
  if (!stuck.empty()) return part(kFault, stuck);
  if (!error) return part(ended() && !stopped_ ? kEnd : kStop, {});
  try {
    std::rethrow_exception(error);
  } catch (const std::exception& e) {
    part(kFault, e.what());
  }
}

void RankGate::part(Farewell::Reason reason, const std::string& text) {
  sending_.clear();
  const std::string cause = cause_.empty() ? fmt::format("rank {}: {}", rank_, text) : cause_;
  for (std::uint32_t r = 0; r < peers_.size(); ++r) {
    if (r == rank_) continue;
    sending_.farewell = Farewell{reason, cause};
    send_now(r, sending_);
  }
  const Clock::time_point until = Clock::now() + kParting;
  const auto others_open = [this] {
    for (std::uint32_t r = 0; r < peers_.size(); ++r)
      if (r != rank_ && (!peers_[r]->parted || transport_.leaving(r) > 0)) return true;
    return false;
  };
  while (others_open() && Clock::now() < until) {
    std::uint32_t from = 0;
    if (!next_message(from)) {
      std::this_thread::sleep_for(std::chrono::microseconds(50));
      continue;
    }
    if (recorder_ != nullptr) note_received(from, recorder_->now());
    if (!received_.farewell) continue;
    peers_[from]->parted = true;
    stopped_ |= received_.farewell->reason != Farewell::Reason::kEnd;
  }
}

std::vector<RankCounts> RankGate::counts() const {
  std::vector<RankCounts> out;
  for (const auto& peer : peers_) out.push_back(peer->counts);
  return out;
}

std::string RankGate::describe() const {
  return fmt::format("rank {}: {} groups wait until other ranks have their rays", rank_, held_.size());
}

}  // namespace carousel::ringbus
