#include "ringbus/transport/mpi/mpi_transport.h"

#ifdef CAROUSEL_MPI

#include <algorithm>
#include <deque>
#include <limits>
#include <thread>

#define OMPI_SKIP_MPICXX 1  // the C++ bindings, which MPI 3 has dropped
#include <mpi.h>

#include "core/system/error.h"

namespace carousel::ringbus {

namespace {

constexpr int kTag = 1;
// Counts of MPI 3 are ints.
constexpr std::size_t kMost = std::size_t{1} << 28;

int count_of(std::size_t size) {
  if (size > std::numeric_limits<int>::max()) throw SimulationError("a message between ranks is too long for MPI");
  return static_cast<int>(size);
}

/// A call that fails ends the program by MPI's own handler, which names the call.
class OpenMpi final : public MpiTransport {
 public:
  OpenMpi() {
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &ranks_);
    MPI_Comm_dup(MPI_COMM_WORLD, &leaving_all_);
    leaving_.resize(static_cast<std::size_t>(ranks_));
  }

  std::uint32_t rank() const override { return static_cast<std::uint32_t>(rank_); }
  std::uint32_t ranks() const override { return static_cast<std::uint32_t>(ranks_); }

  void send(std::uint32_t to, std::span<const std::uint64_t> words) override {
    Message message;
    if (!spare_.empty()) {
      message.words = std::move(spare_.back());
      spare_.pop_back();
    }
    message.words.assign(words.begin(), words.end());
    // Moving a vector leaves its words where they are, so MPI may read them until the request is done.
    MPI_Isend(message.words.data(), count_of(message.words.size()), MPI_UINT64_T, static_cast<int>(to), kTag,
              MPI_COMM_WORLD, &message.request);
    leaving_[to].push_back(std::move(message));
  }

  std::size_t leaving(std::uint32_t to) override {
    std::deque<Message>& messages = leaving_[to];
    while (!messages.empty()) {
      int done = 0;
      MPI_Test(&messages.front().request, &done, MPI_STATUS_IGNORE);
      if (done == 0) break;
      if (spare_.size() < 16) spare_.push_back(std::move(messages.front().words));
      messages.pop_front();
    }
    return messages.size();
  }

  bool receive(std::uint32_t& from, std::vector<std::uint64_t>& words) override {
    int found = 0;
    MPI_Message message;
    MPI_Status status;
    MPI_Improbe(MPI_ANY_SOURCE, kTag, MPI_COMM_WORLD, &found, &message, &status);
    if (found == 0) return false;
    int count = 0;
    MPI_Get_count(&status, MPI_UINT64_T, &count);
    words.resize(static_cast<std::size_t>(count));
    MPI_Mrecv(words.data(), count, MPI_UINT64_T, &message, MPI_STATUS_IGNORE);
    from = static_cast<std::uint32_t>(status.MPI_SOURCE);
    return true;
  }

  std::vector<std::string> gather(const std::string& bytes) override {
    const int own = count_of(bytes.size());
    std::vector<int> sizes(static_cast<std::size_t>(ranks_)), begins(sizes.size());
    MPI_Allgather(&own, 1, MPI_INT, sizes.data(), 1, MPI_INT, MPI_COMM_WORLD);
    std::size_t all = 0;
    for (std::size_t r = 0; r < sizes.size(); ++r) {
      begins[r] = count_of(all);
      all += static_cast<std::size_t>(sizes[r]);
    }
    std::string joined(all, '\0');
    count_of(all);
    MPI_Allgatherv(bytes.data(), own, MPI_CHAR, joined.data(), sizes.data(), begins.data(), MPI_CHAR, MPI_COMM_WORLD);
    std::vector<std::string> out;
    for (std::size_t r = 0; r < sizes.size(); ++r)
      out.push_back(joined.substr(static_cast<std::size_t>(begins[r]), static_cast<std::size_t>(sizes[r])));
    return out;
  }

  void sum(std::span<std::uint64_t> numbers) override {
    while (!numbers.empty()) {
      const std::span<std::uint64_t> some = numbers.first(std::min(numbers.size(), kMost));
      // Modulo 2^64, as arithmetic of unsigned numbers is.
      MPI_Reduce(rank_ == 0 ? MPI_IN_PLACE : some.data(), some.data(), count_of(some.size()), MPI_UINT64_T, MPI_SUM, 0,
                 MPI_COMM_WORLD);
      numbers = numbers.subspan(some.size());
    }
  }

  void leave() override { MPI_Finalize(); }
  void leave_within(std::chrono::milliseconds time) override {
    using Clock = std::chrono::steady_clock;
    const Clock::time_point until = Clock::now() + time;
    MPI_Request request;
    MPI_Ibarrier(leaving_all_, &request);
    for (int done = 0; Clock::now() < until; std::this_thread::sleep_for(std::chrono::milliseconds(1))) {
      MPI_Test(&request, &done, MPI_STATUS_IGNORE);
      if (done != 0) return leave();
    }
  }

 private:
  struct Message {
    std::vector<std::uint64_t> words;
    MPI_Request request = MPI_REQUEST_NULL;
  };

  int rank_ = 0, ranks_ = 1;
  MPI_Comm leaving_all_ = MPI_COMM_NULL;      // for leave_within(), whatever others wait for
  std::vector<std::deque<Message>> leaving_;  // by rank
  std::vector<std::vector<std::uint64_t>> spare_;
};

}  // namespace

std::unique_ptr<MpiTransport> MpiTransport::start() {
  // One thread of a run sends and receives, and another one before and after it.
  int level = MPI_THREAD_SINGLE;
  MPI_Init_thread(nullptr, nullptr, MPI_THREAD_SERIALIZED, &level);
  if (level < MPI_THREAD_SERIALIZED) throw FileError("this MPI was built without threads (MPI_THREAD_SERIALIZED)");
  return std::make_unique<OpenMpi>();
}

bool MpiTransport::built() {
  return true;
}

}  // namespace carousel::ringbus

#else

namespace carousel::ringbus {

std::unique_ptr<MpiTransport> MpiTransport::start() {
  return nullptr;
}

bool MpiTransport::built() {
  return false;
}

}  // namespace carousel::ringbus

#endif
