#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <exception>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/statistics/rank_counts.h"
#include "ringbus/native/links/rank_link.h"
#include "ringbus/native/native_recorder.h"
#include "ringbus/native/ranks/held_groups.h"
#include "ringbus/native/ranks/remote_results.h"
#include "ringbus/native/ranks/shape_travel.h"
#include "ringbus/protocol/machine.h"
#include "ringbus/queues/completed_queue.h"
#include "ringbus/ranks/end_count.h"
#include "ringbus/ranks/rank_message.h"
#include "ringbus/rays/remote_placing.h"
#include "ringbus/transport/transport.h"

namespace carousel::ringbus {

/// This rank's way to the others: gathers packets, new rays and completed rays by the rank they go to, sends them in
/// one message each while earlier ones have left, and takes apart what the others send. One thread at a time steps it;
/// the rest any thread may call.
class RankGate final : public RemotePlacing {
 public:
  /// Keeps references.
  RankGate(const Config& config, Transport& transport, Machine& machine, CompletedQueue& completed);

  /// The link of a wire of which not both ends are here.
  std::unique_ptr<Link> make_link(std::uint32_t wire, std::size_t depth);
  /// True if both ends of a wire are here.
  bool here(const Topology::Wire& wire) const { return machine_.share.here(wire.from) && machine_.share.here(wire.to); }

  void load(ResourceId resource, std::span<const RayId> ids, std::span<const RayRequest> rays) override;
  void hold(ResourceId issuer, RayGroup&& group) override;
  /// Sends those of the completed rays of `resource` away that other ranks shade, and returns the others in place.
  /// `slots` are the slots that they leave.
  void send_results(ResourceId resource, HitBatch& done, std::vector<std::uint32_t>& slots);

  /// The shapes that travel with packets; null where every rank has all.
  const ShapeTravel* shapes() const { return shapes_ ? &*shapes_ : nullptr; }

  /// From now on its messages are noted. Before the first step.
  void record(NativeRecorder& recorder) { recorder_ = &recorder; }
  /// Before the first step: the others live from now on.
  void start();
  /// A thread has found nothing to do at its resources. Any thread may call.
  // Relaxed: only a hint that messages should leave soon. Read first, so that threads that wait do not fight for it.
  void found_nothing() {
    if (!idle_.load(std::memory_order_relaxed)) idle_.store(true, std::memory_order_relaxed);
  }
  /// Sends and receives. `at_rest`: this rank has no rays of its own and none of its packets is under way. Returns
  /// whether anything moved. Throws a SimulationError that names a rank which has ended the run or fallen silent.
  bool step(bool at_rest);
  /// The run is over: rank 0 has counted that all is done, or a rank has been stopped.
  bool ended() const { return ended_.load(std::memory_order_acquire); }
  /// A rank has ended the run before all was done because somebody asked it to.
  bool stopped() const { return stopped_; }
  /// Tells the others how the run has ended here, by an `error`, because it was `stuck`, or well; and waits until they
  /// have told it, too: not for ever where one has failed.
  void part(const std::exception_ptr& error, const std::string& stuck);

  /// By rank.
  std::vector<RankCounts> counts() const;
  /// For a run that is stuck.
  std::string describe() const;

 private:
  using Clock = std::chrono::steady_clock;
  // A rank with nothing to say says so. This is not the transport's sign of life, which a process gives as long as any
  // of its threads runs: it comes from the threads that trace.
  static constexpr std::chrono::milliseconds kSign{200}, kParting{3000};
  // Things for a rank gather for so long, or until there are so many: a message costs more than all but its size. While
  // one of the two ranks has nothing to do, they leave sooner; and also when a link has used up much of its depth,
  // which the others then wait for.
  static constexpr std::chrono::microseconds kWindow{400}, kSoon{50};
  static constexpr std::size_t kFull = 4096, kDepthShare = 4;
  static constexpr std::size_t kLeaving = 2;  // messages to a rank that may be on their way out

  /// The state between this rank and one other.
  struct Peer {
    std::mutex mutex;  // guards `next` and `rays_sent`
    RankMessage next;
    std::uint64_t rays_sent = 0;
    std::uint64_t rays_taken = 0, rays_received = 0, rays_told = 0;
    bool held = false;  // the group being placed has rays there
    bool parted = false;
    bool hungry = false;                      // it has said so
    bool idled = false, told_hungry = false;  // this rank since its last message, and in that
    std::vector<std::uint32_t> in_wires;
    std::vector<std::uint64_t> credits_told;  // by in_wires
    Clock::time_point heard, said;
    std::optional<Clock::time_point> held_since;  // something to send waits for earlier messages to leave
    std::uint64_t messages_received = 0;
    RankCounts counts;
  };

  bool send(std::uint32_t rank, bool idle);
  bool receive();
  bool next_message(std::uint32_t& from);
  void note_received(std::uint32_t from, std::uint64_t begin);
  void take(std::uint32_t from, const RankMessage& message);
  bool deliver_held();
  void pass_token(bool at_rest);
  void part(Farewell::Reason reason, const std::string& text);
  void send_now(std::uint32_t rank, RankMessage& message);

  Transport& transport_;
  Machine& machine_;
  std::uint32_t rank_;
  std::size_t depth_;  // depth of each link
  NativeRecorder* recorder_ = nullptr;
  std::optional<ShapeTravel> shapes_;
  std::vector<std::unique_ptr<Peer>> peers_;  // by rank; this one's own is not used
  std::vector<RankLink*> links_;              // by wire; null where both ends are here
  HeldGroups held_;
  RemoteResults results_;
  EndCount end_;
  std::optional<EndToken> token_;  // to be sent to the next rank
  std::atomic<bool> ended_{false}, idle_{false};
  bool stopped_ = false;
  std::string cause_;                 // another rank's, why the run has ended
  RankMessage sending_, received_;    // scratch
  std::vector<std::uint64_t> words_;  // scratch
};

}  // namespace carousel::ringbus
