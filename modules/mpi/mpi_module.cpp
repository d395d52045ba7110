#include <algorithm>
#include <cstdlib>
#include <mutex>
#include <thread>
#include <utility>

#include <dlfcn.h>
#include <fmt/format.h>

#include "core/module/module.h"
#include "core/system/error.h"
#include "modules/mpi/call_guard.h"
#include "modules/mpi/mailbox.h"
#include "ringbus/transport/mpi_transport.h"

namespace carousel::ringbus {

namespace {

using Clock = std::chrono::steady_clock;

// Words of a sum that travel in one message.
constexpr std::size_t kSumWords = std::size_t{1} << 17;
constexpr std::chrono::milliseconds kPollInterval{50}, kSign{200};
// A thread that looked so late has not run meanwhile, and cannot blame others.
constexpr std::chrono::milliseconds kLate{1000};
// A rank that has not waited for others for so long is busy with its own, and ends without being asked; all have said
// then who is missing, and wait so long for one another to say it.
constexpr std::chrono::milliseconds kAway{1500}, kParting{3000};

/// A call that fails ends the program by MPI's own handler, which names the call. All calls are made under one mutex
/// (MPI_THREAD_SERIALIZED), and none waits.
class OpenMpi final : public MpiTransport {
 public:
  OpenMpi(int rank, int ranks, Say say)
      : say_(std::move(say)),
        rank_(rank),
        ranks_(ranks),
        mail_(static_cast<std::size_t>(ranks)),
        peers_(static_cast<std::size_t>(ranks)) {
    called_ = tended_ = Clock::now();
    for (Peer& peer : peers_) peer.heard = tended_;
    peers_[own()].parted = true;  // nothing is expected of this rank
    if (ranks_ > 1) watch_ = std::jthread([this](const std::stop_token& ended) { watch(ended); });
  }

  std::uint32_t rank() const override { return static_cast<std::uint32_t>(rank_); }
  std::uint32_t ranks() const override { return static_cast<std::uint32_t>(ranks_); }

  void send(std::uint32_t to, std::span<const std::uint64_t> words) override {
    const std::lock_guard lock(mutex_);
    turn();
    std::vector<std::uint64_t> copy = mail_.spare();
    copy.assign(words.begin(), words.end());
    mail_.post(to, kRun, std::move(copy));
  }

  std::size_t leaving(std::uint32_t to) override {
    const std::lock_guard lock(mutex_);
    turn();
    return mail_.leaving(to);
  }

  bool receive(std::uint32_t& from, std::vector<std::uint64_t>& words) override {
    const std::lock_guard lock(mutex_);
    turn();
    if (mail_.coming == MPI_REQUEST_NULL &&
        !mail_.begin_to_take(MPI_ANY_SOURCE, kRun, mail_.coming_words, MPI_UINT64_T))
      return false;
    if (!Mailbox::done(mail_.coming))
      return false;  // a long one of a rank that has stopped in the midst of it never is
    from = static_cast<std::uint32_t>(mail_.coming_from);
    words.swap(mail_.coming_words);
    return true;
  }

  std::vector<std::string> gather(const std::string& bytes) override {
    {
      const std::lock_guard lock(mutex_);
      for (std::uint32_t r = 0; r < ranks(); ++r)
        if (r != rank()) mail_.post(r, kGather, std::vector<char>(bytes.begin(), bytes.end()));
    }
    std::vector<std::string> out(peers_.size(), bytes);
    for (std::uint32_t r = 0; r < ranks(); ++r) {
      if (r == rank()) continue;
      take(r, kGather, mail_.coming_bytes, MPI_CHAR);
      out[r].assign(mail_.coming_bytes.begin(), mail_.coming_bytes.end());
    }
    return out;
  }

  /// Along a binomial tree, so that rank 0 takes in as many films as there are digits in the number of ranks.
  void sum(std::span<std::uint64_t> numbers) override {
    while (!numbers.empty()) {
      const std::span<std::uint64_t> some = numbers.first(std::min(numbers.size(), kSumWords));
      std::vector<std::uint64_t> part(some.begin(), some.end());
      for (std::uint32_t step = 1; step < ranks(); step *= 2) {
        if ((rank() & step) != 0) {
          const std::lock_guard lock(mutex_);
          mail_.post(rank() - step, kSum, std::move(part));
          break;
        }
        if (rank() + step >= ranks()) continue;
        take(rank() + step, kSum, mail_.coming_words, MPI_UINT64_T);
        for (std::size_t i = 0; i < part.size(); ++i) part[i] += mail_.coming_words.at(i);  // modulo 2^64
      }
      if (rank_ == 0) std::copy(part.begin(), part.end(), some.begin());
      numbers = numbers.subspan(some.size());
    }
  }

  void leave() override {
    say_bye();
    wait([this] { return all_parted(); });
    finalize();
  }

  void leave_within(std::chrono::milliseconds time) override {
    if (part(time)) finalize();
  }

 private:
  struct Peer {
    Clock::time_point heard;
    MPI_Request sign = MPI_REQUEST_NULL;  // this rank's last one to it
    bool parted = false, missing = false;
  };

  std::size_t own() const { return static_cast<std::size_t>(rank_); }

  // Under the mutex.

  /// The caller's thread is at work with others.
  void turn() { tend(called_ = Clock::now()); }

  /// Gives and takes signs of life, when it is time.
  void tend(Clock::time_point now) {
    if (now - tended_ < kPollInterval) return;
    if (now - tended_ > kLate)
      for (Peer& peer : peers_) peer.heard = now;
    tended_ = now;
    mail_.take_empty(kLife, [&](std::size_t r) { peers_[r].heard = now; });
    mail_.take_empty(kBye, [&](std::size_t r) { peers_[r].parted = true; });
    for (std::uint32_t r = 0; r < ranks(); ++r) {
      Peer& peer = peers_[r];
      if (peer.parted || peer.missing) continue;
      if (now - signed_ >= kSign && Mailbox::done(peer.sign))
        MPI_Isend(nullptr, 0, MPI_CHAR, static_cast<int>(r), kLife, MPI_COMM_WORLD, &peer.sign);
      if (now - peer.heard <= kRankSilence) continue;
      peer.missing = true;
      if (missing_.empty()) missing_ = fmt::format("rank {}", r);
      say_(fmt::format("rank {} has said nothing for {} seconds; it hangs or has died", r, kRankSilence.count()));
    }
    if (now - signed_ >= kSign) signed_ = now;
  }

  bool all_parted() const {
    return std::all_of(peers_.begin(), peers_.end(), [](const Peer& peer) { return peer.parted; });
  }

  // Without the mutex.

  template <class Done>
  void wait(const Done& come) {
    for (int polls = 0;; ++polls) {
      {
        const std::lock_guard lock(mutex_);
        turn();
        if (come()) return;
        if (!missing_.empty()) throw SimulationError(fmt::format("the run ends, since {} is missing", missing_));
      }
      if (polls < 100)
        std::this_thread::yield();
      else
        std::this_thread::sleep_for(std::chrono::microseconds(100));
    }
  }

  template <class Unit>
  void take(std::uint32_t from, Tag tag, std::vector<Unit>& into, MPI_Datatype type) {
    wait([&] { return mail_.begin_to_take(static_cast<int>(from), tag, into, type); });
    wait([&] { return Mailbox::done(mail_.coming); });
  }

  void say_bye() {
    const std::lock_guard lock(mutex_);
    if (std::exchange(bye_said_, true)) return;
    for (std::uint32_t r = 0; r < ranks(); ++r)
      if (r != rank()) mail_.post(r, kBye, std::vector<char>());
  }

  /// Waits until all have parted that are not missing. Returns whether all are here.
  bool part(std::chrono::milliseconds time) {
    say_bye();
    for (const Clock::time_point until = Clock::now() + time; Clock::now() < until;
         std::this_thread::sleep_for(std::chrono::milliseconds(1))) {
      const std::lock_guard lock(mutex_);
      turn();
      if (all_parted()) return true;
      if (std::all_of(peers_.begin(), peers_.end(), [](const Peer& p) { return p.parted || p.missing; })) return false;
    }
    return false;
  }

  /// All have said their last word, and none watches another any more.
  void finalize() {
    watch_ = {};
    const CallGuard guard("MPI_Finalize", say_);
    for (std::uint32_t r = 0; r < ranks(); ++r)
      while (mail_.leaving(r) > 0 || !Mailbox::done(peers_[r].sign)) std::this_thread::yield();
    MPI_Finalize();
  }

  /// Gives signs of life while the other threads are busy with something else.
  void watch(const std::stop_token& ended) {
    for (; !ended.stop_requested(); std::this_thread::sleep_for(kPollInterval)) {
      {
        const std::unique_lock lock(mutex_, std::try_to_lock);
        if (!lock) continue;  // the thread that holds the lock tends the others
        const Clock::time_point now = Clock::now();
        tend(now);
        if (missing_.empty() || now - called_ < kRankSilence + kAway) continue;
      }
      part(kParting);
      std::_Exit(1);
    }
  }

  Say say_;
  int rank_, ranks_;
  std::mutex mutex_;  // guards MPI and all below
  Mailbox mail_;
  std::vector<Peer> peers_;  // by rank
  Clock::time_point called_, tended_, signed_;
  std::string missing_;  // the first rank that was missed
  bool bye_said_ = false;
  std::jthread watch_;  // ends before the others
};

/// Open MPI loads components of its own, which look for its names among all that the process has (RTLD_GLOBAL), where a
/// library that a module brings does not stand: Open MPI's FAQ, "Can I dlopen() libmpi". This moves it there.
void show_names() {
  Dl_info found{};
  if (dladdr(reinterpret_cast<void*>(&MPI_Init_thread), &found) == 0 ||
      dlopen(found.dli_fname, RTLD_NOW | RTLD_GLOBAL | RTLD_NOLOAD) == nullptr)
    throw FileError("the library of MPI cannot be shown to its components");
}

std::unique_ptr<MpiTransport> start(const MpiTransport::Say& say) {
  show_names();
  // One thread of a run sends and receives, another one before and after it, and one gives signs of life.
  int level = MPI_THREAD_SINGLE;
  {
    const CallGuard guard("MPI_Init_thread", say);
    MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &level);
  }
  if (level < MPI_THREAD_SERIALIZED) throw FileError("this MPI was built without threads (MPI_THREAD_SERIALIZED)");
  int rank = 0, ranks = 1;
  MPI_Comm_rank(MPI_COMM_WORLD, &rank);
  MPI_Comm_size(MPI_COMM_WORLD, &ranks);
  return std::make_unique<OpenMpi>(rank, ranks, say);
}

/// "Open MPI v4.1.4"
std::string library() {
  char text[MPI_MAX_LIBRARY_VERSION_STRING];
  int size = 0;
  MPI_Get_library_version(text, &size);
  const std::string all(text, static_cast<std::size_t>(size));
  return all.substr(0, all.find(','));
}

}  // namespace
}  // namespace carousel::ringbus

const carousel::ModuleInfo* carousel_module() {
  using namespace carousel;
  static const ringbus::MpiModule functions{ringbus::start};
  static const ModuleInfo info{.build = module_build(),
                               .name = ringbus::MpiModule::kModule,
                               .brings = "runs over several processes and hosts (engine.transport: mpi)",
                               .library = ringbus::library,
                               .functions = &functions};
  return &info;
}
