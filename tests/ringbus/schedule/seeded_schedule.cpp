#include "tests/ringbus/schedule/seeded_schedule.h"

#include <array>
#include <utility>

namespace carousel::ringbus {

namespace {
constexpr std::uint64_t kMostPointsOfARun = 20'000'000;  // a run that takes more does not end by itself
}

SeededSchedule::SeededSchedule() {
  agents_.push_back({std::make_unique<Fibre>(), {}, 0});
  follow(this);
}

SeededSchedule::~SeededSchedule() {
  follow(nullptr);
}

void SeededSchedule::begin(std::uint64_t seed) {
  state_ = seed * 0x9e3779b97f4a7c15u;
  points_ = choices_ = 0;
  stop_at_ = kMostPointsOfARun;
  stop_ = {};
  now_ = Clock::time_point(std::chrono::hours(1));
  begin_phase();
}

// SplitMix64 (Steele, Lea, Flood 2014).
std::uint64_t SeededSchedule::draw() {
  std::uint64_t x = state_ += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

void SeededSchedule::begin_phase() {
  constexpr std::array<std::uint32_t, 6> kWeights{0, 0, 1, 1, 4, 32};
  phase_end_ = points_ + 1 + draw(std::uint64_t{1} << draw(9));
  if (draw(4) == 0 || points_ == 0) step_ = std::chrono::microseconds(16 << draw(8));
  weights_ = 0;
  std::size_t able = 0;
  for (std::size_t a = 0; a < agents_.size(); ++a) {
    const bool is_able = a == 0 || agents_[a].body;
    able += is_able;
    weights_ += agents_[a].weight = is_able ? kWeights[draw(kWeights.size())] : 0;
  }
  if (weights_ > 0) return;
  std::size_t one = draw(able);  // all would rest
  for (std::size_t a = 0; weights_ == 0; ++a)
    if ((a == 0 || agents_[a].body) && one-- == 0) weights_ = agents_[a].weight = 1;
}

std::size_t SeededSchedule::choose() {
  ++points_;
  now_ += step_;
  if (points_ == stop_at_) stop_.request_stop();
  if (points_ >= phase_end_) begin_phase();
  std::size_t agent = 0;
  for (std::uint64_t left = draw(weights_); left >= agents_[agent].weight; ++agent) left -= agents_[agent].weight;
  choices_ = (choices_ ^ agent) * 0xbf58476d1ce4e5b9u + 1;
  return agent;
}

void SeededSchedule::yield() {
  const std::size_t next = choose();
  if (next == running_) return;
  Fibre& from = *agents_[std::exchange(running_, next)].fibre;
  agents_[next].fibre->resume(from);
}

void SeededSchedule::start(std::function<void()> body) {
  std::size_t agent = 1;
  while (agent < agents_.size() && agents_[agent].body) ++agent;
  if (agent == agents_.size()) agents_.push_back({std::make_unique<Fibre>([this, agent] { run_agent(agent); }), {}, 0});
  agents_[agent].body = std::move(body);
  begin_phase();
}

void SeededSchedule::run_agent(std::size_t agent) {
  for (;;) {
    agents_[agent].body();
    agents_[agent].body = {};
    begin_phase();
    yield();
  }
}

}  // namespace carousel::ringbus
