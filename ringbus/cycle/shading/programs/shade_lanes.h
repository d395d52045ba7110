#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/program/arithmetic.h"
#include "core/program/program.h"
#include "core/types/shade_facts.h"

namespace carousel::ringbus::cycle {

/// Rays that go through a shader program in step, one a lane. The instruction that comes first in the program among
/// those that lanes are at is the next one; lanes that are elsewhere wait. As blocks lie within one another, and loops
/// end behind their bodies, lanes that part at a branch meet again behind its block.
class ShadeLanes {
 public:
  /// `facts` by lane, 1 to 64; keeps a reference to the program.
  void begin(const RayProgram& program, const std::vector<const ShadeFacts*>& facts) {
    program_ = &program;
    lanes_.resize(facts.size());
    for (std::size_t i = 0; i < facts.size(); ++i) {
      lanes_[i] = {};
      std::copy(facts[i]->value.begin(), facts[i]->value.end(), lanes_[i].r.begin());
    }
    find_next();
  }
  /// False when all lanes are at the end.
  bool running() const { return at_ < program_->code.size(); }
  std::size_t at() const { return at_; }
  const Instruction& next() const { return program_->code[at_]; }
  /// The lanes that are at the next instruction, a bit each.
  std::uint64_t active() const { return active_; }
  std::size_t active_lanes() const { return static_cast<std::size_t>(std::popcount(active_)); }

  /// Does the next instruction, in the lanes that are there.
  void execute() {
    const Instruction& i = next();
    for (std::size_t lane = 0; lane < lanes_.size(); ++lane)
      if (active_ >> lane & 1) execute(i, lanes_[lane]);
    find_next();
  }

 private:
  struct Lane {
    std::array<float, kMostRegisters> r{};
    std::array<std::uint32_t, kMostLoops> counter{};
    std::size_t at = 0;
  };

  static void execute(const Instruction& i, Lane& lane) {
    ++lane.at;
    switch (i.op) {
      case Op::kLoop:
        lane.counter[i.c] = static_cast<std::uint32_t>(i.value);
        return;
      case Op::kEnd:
        if (--lane.counter[i.c] > 0) lane.at = i.target;
        return;
      case Op::kIfZero:
        if (lane.r[i.a] == 0) lane.at = i.target;
        return;
      case Op::kIfNonzero:
        if (lane.r[i.a] != 0) lane.at = i.target;
        return;
      case Op::kJump:
        lane.at = i.target;
        return;
      case Op::kTrace:
        return;
      default:
        lane.r[i.d] = value_of(i, lane.r[i.a], lane.r[i.b], lane.r[i.c]);
    }
  }
  void find_next() {
    at_ = program_->code.size();
    for (const Lane& lane : lanes_) at_ = std::min(at_, lane.at);
    active_ = 0;
    for (std::size_t i = 0; i < lanes_.size(); ++i)
      if (lanes_[i].at == at_) active_ |= std::uint64_t{1} << i;
  }

  const RayProgram* program_ = nullptr;
  std::vector<Lane> lanes_;
  std::size_t at_ = 0;
  std::uint64_t active_ = 0;
};

}  // namespace carousel::ringbus::cycle
